"""One quadratic function for each step of a round, where modes take turns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest
from typing import Any, ClassVar, Self

from nrs_design.proof.clock import on_turn
from nrs_design.proof.evidence.conewise_quadratic import in_threes, multiplier_count
from nrs_design.proof.evidence.fields import (
    Matrix,
    matrix_fields,
    rate_words,
    read_dyadic,
    read_integers,
    read_ratio,
)
from nrs_design.proof.evidence.function import AbstractFunction, is_square
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.steps import Steps, find_odd_roundings
from nrs_design.proof.system import SwitchedSystem

NO_CLOCK = "the modes of the system do not take turns"


@dataclass(frozen=True, slots=True)
class PeriodicQuadratic(AbstractFunction):
    """``V_j(w) = w' Q_j w`` at the step j of a round decreases to ``V_(j+1)`` after it.

    The first function follows the last. At each step the modes whose turn it is are those of a
    system of their own, and the conditions are those of `nrs_design.proof.steps.Steps` for it, from
    Q_j to Q_(j+1): ``rho^2 Q_j - A' Q_(j+1) A > 0`` for every mode, and where contact may be lost,
    ``w = (y, max(delta, 0))``, with what `nrs_design.proof.evidence.conewise_quadratic` adds.
    """

    kind: ClassVar[str] = "periodic-quadratic"
    bounds_at_once: ClassVar[bool] = True
    covers_mixtures: ClassVar[bool] = True
    covers_lost_contact: ClassVar[bool] = True
    covers_clock: ClassVar[bool] = True

    # Shape (n, n). Integer numerators of the Q_j, from the first step of a round on.
    functions: tuple[Matrix, ...]
    denominator_log2: int  # All of them, and all multipliers, are over two to this power
    rate: Fraction  # The rho per step
    # For each step, as in `nrs_design.proof.evidence.conewise_quadratic`; empty where contact is
    # not lost.
    multipliers: tuple[tuple[int, ...], ...] = ()
    # For each step the multipliers for what the arithmetic rounds, if that is covered.
    roundings: tuple[tuple[int, ...], ...] = ()

    @property
    def covers_rounding(self) -> bool:
        """Whether it has the multipliers for it."""
        return bool(self.roundings)

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: the level sets of every function are convex in contact, and free."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check that modes take turns, shapes, and the signs of rate and multipliers."""
        contact, clock = system.contact, system.clock
        if clock is None:
            return NO_CLOCK
        if len(self.functions) != clock.length:
            return "there is not one function for each step of a round"
        if not all(is_square(Q, system.order) for Q in self.functions):
            return f"a function is not a {system.order} x {system.order} matrix"
        steps = () if contact is None else (multiplier_count(contact, system.time),) * clock.length
        if tuple(map(len, self.multipliers)) != steps:
            return "there is not one multiplier for each condition that needs it"
        if any(entry < 0 for entries in self.multipliers for entry in entries):
            return "a multiplier is negative"
        if self.roundings and not (len(self.roundings) == clock.length and all(self.roundings)):
            return "there are not multipliers of roundings for each step of a round"
        for entries in self.roundings:
            if (odd := find_odd_roundings(entries, system)) is not None:
                return odd
        return self.find_rate_misfit(Time.DISCRETE)

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield the functions, and their decreases over every step of a round."""
        clock = system.clock
        assert clock is not None  # find_misfit
        for step, Q in enumerate(self.functions):
            yield f"the function of step {step} is not symmetric and positive definite", Q
        parts = on_turn(system, clock, 0), on_turn(system, clock, 1)
        after = (*self.functions[1:], self.functions[0])
        each = zip_longest(self.functions, after, self.multipliers, self.roundings, fillvalue=())
        for step, (Q, following, multipliers, roundings) in enumerate(each):
            crossing, *lagging = multipliers or (0,)
            steps = Steps(
                Q,
                self.denominator_log2,
                self.rate**2,
                crossing,
                roundings,
                lagging=in_threes(lagging),
                after=following,
            )
            for where, form in steps.forms(parts[min(step, 1)]):
                yield f"V does not decrease at the claimed rate {where}, at step {step}", form

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution."""
        count = len(self.functions)
        lost = w = end = ""
        if system.contact is not None:
            lost = ", with contact lost and made again at any time,"
            w = (
                "w holds the states other than the deflection, and the deflection where it is "
                "positive, and "
            )
            end = " Where free motion ends is not claimed."
        else:
            w = "w is the state, and "
        return (
            f"In rounds of {count} steps, every solution of x+ = A x{lost} and with any mode in "
            "force whose turn it is, satisfies |w(t)| <= rho^t |w(0)| with "
            f"{rate_words(self.rate, system.time)}, where {w}|w| = sqrt(w' Q w) with the Q of the "
            f"step of its round.{end}"
        )

    def to_fields(self) -> dict[str, Any]:
        """Return the functions, the rate and the multipliers."""
        fields: dict[str, Any] = {
            "functions": [matrix_fields(Q, self.denominator_log2) for Q in self.functions],
            "rate": str(self.rate),
            "multipliers": [list(entries) for entries in self.multipliers],
        }
        if self.roundings:
            fields["roundings"] = [list(entries) for entries in self.roundings]
        return fields

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the functions, the rate and the multipliers; they say nothing without turns."""
        if system.clock is None:
            raise ValueError(NO_CLOCK)
        read = [read_dyadic(item) for item in fields["functions"]]
        if len({exponent for _, exponent in read}) != 1:
            raise ValueError("the functions do not share one denominator")
        return cls(
            tuple(Q for Q, _ in read),
            read[0][1],
            read_ratio(fields["rate"]),
            read_integers(fields["multipliers"]),
            read_integers(fields.get("roundings", [])),
        )
