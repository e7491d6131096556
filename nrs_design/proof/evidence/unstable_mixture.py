"""A convex combination of modes that is not stable: switching fast enough comes near it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import Any, ClassVar, Self

from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.fields import read_ratio, read_text
from nrs_design.proof.evidence.unstable_mode import (
    is_spectrum_too_large,
    is_stable,
    worst_eigenvalue,
)
from nrs_design.proof.exact import IntegerMatrix, common_denominator
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem

# Longer weights make no better mixtures, only longer computations.
MAX_DENOMINATOR = 2**64


@dataclass(frozen=True, slots=True)
class UnstableMixture(AbstractEvidence):
    """``sum w_i A_i`` with ``w_i > 0`` and ``sum w_i = 1`` is not Hurwitz (continuous time).

    Uniform exponential stability under arbitrary switching carries over to all convex
    combinations of the modes (Molchanov and Pyatnitskiy 1989), so one unstable combination
    refutes it: periodic switching with these shares and a short period follows the average.
    """

    kind: ClassVar[str] = "unstable-mixture"

    weights: tuple[tuple[str, Fraction], ...]  # Share of each mode
    eigenvalue: str  # Worst eigenvalue of the combination, to six digits, for the reader

    @property
    def shows(self) -> Shows:
        """Instability."""
        return Shows.INSTABILITY

    @property
    def used(self) -> frozenset[str]:
        """The modes of the average."""
        return frozenset(name for name, _ in self.weights)

    def fits(self, switching: Switching) -> bool:
        """Tell whether switching is arbitrary, so that it can be as fast as needed."""
        return switching.is_arbitrary

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check the weights, and that the combination is not Hurwitz."""
        if system.time is not Time.CONTINUOUS:
            return "mixing modes is for continuous time"
        if any(weight <= 0 for _, weight in self.weights) or sum(w for _, w in self.weights) != 1:
            return "the weights are not positive with sum one"
        if not _are_short(self.weights):
            return "the weights have too many digits"
        names = [name for name, _ in self.weights]
        if len(set(names)) < len(names) or not set(names) <= {m.name for m in system.modes}:
            return "the weights are not those of modes"
        if not _is_short_mixture(system, self.weights):
            return "the numbers of the combination are too large to check"
        combined = mixture(system, self.weights)
        if is_spectrum_too_large(combined):
            return "the numbers of the combination are too large to check"
        if is_stable(combined, system.time):
            return "the combination of the modes is stable"
        return None

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield nothing: no matrix has to be positive definite."""
        yield from ()

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the combination and what follows."""
        shares = " + ".join(f"{weight} {name}" for name, weight in self.weights)
        return (
            f"The average {shares} of modes is not Hurwitz (eigenvalue about {self.eigenvalue}): "
            "fast switching with these shares follows it, so x' = A x is not uniformly "
            "exponentially stable under arbitrary switching."
        )

    def to_fields(self) -> dict[str, Any]:
        """Return the weights and the eigenvalue."""
        return {
            "weights": [[name, str(weight)] for name, weight in self.weights],
            "eigenvalue": self.eigenvalue,
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the weights; the eigenvalue is computed again."""
        weights = tuple((read_text(name), read_ratio(w)) for name, w in fields["weights"])
        if len(weights) > len(system.modes) or not _are_short(weights):
            raise ValueError("there are too many weights, or they have too many digits")
        if not _is_short_mixture(system, weights):
            raise ValueError("the numbers of the combination are too large to check")
        return cls(weights, worst_eigenvalue(mixture(system, weights), system.time))


def _are_short(weights: tuple[tuple[str, Fraction], ...]) -> bool:
    denominator = lcm(*(weight.denominator for _, weight in weights))
    return denominator <= MAX_DENOMINATOR and all(weight <= 1 for _, weight in weights)


def _is_short_mixture(system: SwitchedSystem, weights: tuple[tuple[str, Fraction], ...]) -> bool:
    """Tell whether the modes have a common denominator that is worth working with."""
    denominators = {mode.name: mode.A.denominator for mode in system.modes}
    common = common_denominator(denominators.get(name, 1) for name, _ in weights)
    return common is not None


def mixture(system: SwitchedSystem, weights: tuple[tuple[str, Fraction], ...]) -> RationalMatrix:
    """Return the exact weighted sum of modes."""
    modes = {mode.name: mode.A.fractions() for mode in system.modes}
    n = system.order
    return RationalMatrix.from_rows(
        [
            [sum((w * modes[name][i][j] for name, w in weights), Fraction(0)) for j in range(n)]
            for i in range(n)
        ]
    )
