"""One quadratic Lyapunov function for all modes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar, Self

from nrs_design.proof.evidence.fields import (
    matrix_fields,
    rate_words,
    read_dyadic,
    read_ratio,
    read_roundings,
    rounding_fields,
)
from nrs_design.proof.evidence.function import AbstractFunction, is_square
from nrs_design.proof.exact import (
    IntegerMatrix,
    Product,
    lyapunov_decrease,
    multiply,
    stein_decrease,
)
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import Steps, find_odd_roundings
from nrs_design.proof.system import SwitchedSystem

_FAILURE = "V does not decrease at the claimed rate"


@dataclass(frozen=True, slots=True)
class CommonQuadratic(AbstractFunction):
    """``V(x) = x' Q x`` decreases in every mode."""

    kind: ClassVar[str] = "common-quadratic"
    bounds_at_once: ClassVar[bool] = True
    covers_mixtures: ClassVar[bool] = True

    Q: tuple[tuple[int, ...], ...]  # Shape (n, n). Numerators of the symmetric matrix.
    denominator_log2: int  # Q is these numerators over two to this power
    # Continuous time: the decay rate alpha in 1/s, with ``A'Q + QA + 2 alpha Q < 0``. Discrete
    # time: the contraction rho per step, with ``A'QA < rho^2 Q``.
    rate: Fraction
    # Over the denominator of Q: the multipliers of `nrs_design.proof.steps.Steps`, if what the
    # arithmetic rounds is covered.
    roundings: tuple[int, ...] = ()

    @property
    def covers_rounding(self) -> bool:
        """Whether it has the multipliers for it."""
        return bool(self.roundings)

    @property
    def is_common_quadratic(self) -> bool:
        """True: that is what it is."""
        return True

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: the level sets of V are convex."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check shapes and the sign of the rate."""
        if not is_square(self.Q, system.order):
            return f"Q is not a {system.order} x {system.order} matrix"
        if (odd := find_odd_roundings(self.roundings, system)) is not None:
            return odd
        return self.find_rate_misfit(system.time)

    def forms(
        self, system: SwitchedSystem, multiply: Product = multiply
    ) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield Q and the decrease in every mode."""
        yield "Q is not symmetric and positive definite", self.Q
        if self.roundings:
            kept = replace(system, contact=None)
            steps = Steps(self.Q, self.denominator_log2, self.rate**2, roundings=self.roundings)
            yield from ((f"{_FAILURE} {where}", form) for where, form in steps.forms(kept))
            return
        form = lyapunov_decrease if system.time is Time.CONTINUOUS else stein_decrease
        for mode in system.modes:
            N, denominator = mode.A.numerators, mode.A.denominator
            failure = f"{_FAILURE} in mode {mode.name}"
            yield failure, form(N, denominator, self.Q, self.rate, multiply)

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution."""
        return decay_claim(system, self.rate, "in the norm |x| = sqrt(x' Q x)")

    def to_fields(self) -> dict[str, Any]:
        """Return Q and the rate."""
        Q = matrix_fields(self.Q, self.denominator_log2)
        return {"Q": Q, "rate": str(self.rate), **rounding_fields(self.roundings)}

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read Q and the rate."""
        Q, denominator_log2 = read_dyadic(fields["Q"])
        return cls(Q, denominator_log2, read_ratio(fields["rate"]), read_roundings(fields))


def decay_claim(system: SwitchedSystem, rate: Fraction, norm: str) -> str:
    """State that every solution decays at a rate in a norm.

    Parameters
    ----------
    system : SwitchedSystem
        With the time axis.
    rate : Fraction
        The alpha in 1/s, or rho per step.
    norm : str
        In words or symbols.
    """
    continuous = system.time is Time.CONTINUOUS
    law = "x' = A x" if continuous else "x+ = A x"
    bound = "exp(-alpha t) |x(0)|" if continuous else "rho^t |x(0)|"
    count = len(system.modes)
    among = "its one mode" if count == 1 else f"the {count} modes"
    return (
        f"Every solution of {law}, switching arbitrarily among {among}, satisfies "
        f"|x(t)| <= {bound} with {rate_words(rate, system.time)}, {norm}."
    )
