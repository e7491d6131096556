"""What all evidence of stability has in common: functions that decrease at a claimed rate."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.fields import MAX_INTEGER_BITS
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem


class AbstractFunction(AbstractEvidence):
    """Lyapunov functions; the rate is alpha in 1/s, or rho per step, and is itself proved."""

    rate: Fraction

    @property
    def attains_rate(self) -> bool:
        """True: the function decreases at it."""
        return True

    @property
    def shows(self) -> Shows:
        """Stability."""
        return Shows.STABILITY

    def proved_rate(self, system: SwitchedSystem) -> Fraction:
        """Return the claimed rate."""
        return self.rate

    def find_rate_misfit(self, time: Time) -> str | None:
        """Say why the rate is not one of exponential decay, or None."""
        if self.rate <= 0 or (time is Time.DISCRETE and self.rate >= 1):
            return "the claimed rate is not one of exponential decay"
        return None


def find_odd_form(Q: IntegerMatrix, denominator_log2: int, order: int) -> str | None:
    """Say why a form does not have its shape, or None.

    Parameters
    ----------
    Q : integer matrix
        Its numerators.
    denominator_log2 : int
        They are over two to this power.
    order : int
        Number of states.
    """
    if not is_square(Q, order):
        return f"Q is not a {order} x {order} matrix"
    if not 0 <= denominator_log2 <= MAX_INTEGER_BITS:
        return f"the denominator of Q is not two to a power up to {MAX_INTEGER_BITS}"
    return None


def is_square(M: IntegerMatrix, n: int) -> bool:
    """Tell whether a matrix has n rows and n columns."""
    return len(M) == n and all(len(row) == n for row in M)
