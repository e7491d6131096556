"""One function that shows that contact settles under a constant force that pushes in."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows, find_odd_form
from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.exact import IntegerMatrix, lyapunov_decrease
from nrs_design.proof.matrix import RationalMatrix, with_crossing
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem

_NO_RATE = Fraction(0)


@dataclass(frozen=True, slots=True)
class ConstantForce(AbstractEvidence):
    """``V = w'Qw + 2 s max(-1 - e, 0)`` decreases under a constant force that pushes in.

    The loop is driven by F - Fd in place of the force F, with a constant Fd > 0. At a constant
    stiffness it rests at one deflection, where F = Fd, whatever the gains. In units of that
    deflection, and counted from it, the deflection is e, the surface at ``e = -1``, and

        ``y' = A_yy y + h max(e, -1)``, ``e' = c y``, that is ``x' = A w`` with
        ``x = (y, e)``, ``w = (y, max(e, -1))``,

    where A = [[A_yy, h], [c, 0]] is a mode in contact. V is ``x'Qx`` in contact; free, where the
    last entry of w is -1 and does not change, it is quadratic in y and linear in e. It is
    continuous, grows without bound with x since the Schur complement of Q is positive, and
    decreases

    - in contact: ``-(A'Q + QA) > 0`` for every mode;
    - free: with B the rows of y of A and a row of zeros,
      ``-(B'Q + QB) - s (u c + c'u') > 0`` for every mode, where u is the unit vector of the
      deflection: since ``e' = c y`` and the last entry of w is -1, ``-2 s e'`` is
      ``s w'(u c + c'u')w``.

    Both are linear in A: convex combinations are covered. Free, V falls by a positive amount in
    every second, so the time without contact is finite.
    """

    kind: ClassVar[str] = "constant-force"
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True

    Q: Matrix  # Shape (n, n). Numerators of the symmetric matrix.
    denominator_log2: int  # Q is these numerators over two to this power
    slope: int  # The s, over the same denominator; positive

    @property
    def shows(self) -> Shows:
        """Convergence under a constant force."""
        return Shows.CONVERGENCE

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check that contact is one with a spring and can be lost, shapes, and the slope."""
        contact = system.contact
        if contact is None or not contact.pushed:
            return "the system does not say that a constant force pushes into contact"
        if system.time is not Time.CONTINUOUS:
            return "a constant force is covered in continuous time only"
        if contact.pulls:
            return "the environment could pull, which is not covered under a constant force"
        if any(mode.A.numerators[-1][-1] for mode in system.modes):
            return "the deflection acts on its own rate in a mode in contact"
        if _motions(mode.A for mode in system.modes) != _motions(m.A for m in contact.free):
            return "without the deflection, the modes in contact are not those of free motion"
        if (odd := find_odd_form(self.Q, self.denominator_log2, system.order)) is not None:
            return odd
        return None if self.slope > 0 else "the slope is not positive"

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield Q, and the decrease of V in contact and in free motion of every mode."""
        yield "Q is not symmetric and positive definite", self.Q
        for mode in system.modes:
            N, denominator = mode.A.numerators, mode.A.denominator
            in_contact = lyapunov_decrease(N, denominator, self.Q, _NO_RATE)
            yield f"V does not decrease in mode {mode.name}", in_contact
            *moving, deflecting = N
            still = (*moving, (0,) * len(N))
            free = with_crossing(
                lyapunov_decrease(still, denominator, self.Q, _NO_RATE),
                len(N) - 1,
                [-self.slope * entry for entry in deflecting],
            )
            yield f"V does not decrease in the free motion of mode {mode.name}", free

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State where every solution goes, and for which forces and stiffnesses."""
        count = len(system.modes)
        return (
            "Under a constant force that pushes in: for every constant d > 0, every solution of "
            "y' = A_yy y + h (max(delta, 0) - d), delta' = c y, with contact lost and made again "
            f"at any time and switching arbitrarily among the {count} "
            f"mode{'s' * (count != 1)} in contact A = [[A_yy, h], [c, 0]], tends to y = 0 and "
            "delta = d, from every state and uniformly over the switching signals; the time "
            "without contact is finite. At a stiffness that does not change, wherever in its "
            "range, this is the loop driven by F - Fd in place of F, for every constant Fd > 0, "
            "and F settles at Fd. No rate is claimed."
        )


def _motions(matrices: Iterator[RationalMatrix]) -> set[tuple[tuple[Fraction, ...], ...]]:
    """Return how the other states move themselves and the deflection: all columns but the last."""
    return {tuple(tuple(row[:-1]) for row in A.fractions()) for A in matrices}
