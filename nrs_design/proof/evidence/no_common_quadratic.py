"""A proof that no quadratic function decreases in every mode."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from operator import mul
from typing import ClassVar

from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.exact import (
    IntegerMatrix,
    add,
    common_denominator,
    multiply,
    scaled,
    transpose,
)
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from nrs_design.proof.system import SwitchedSystem


@dataclass(frozen=True, slots=True)
class NoCommonQuadratic(AbstractEvidence):
    """``sum A_i X_i + X_i A_i' > 0`` with ``X_i = L_i L_i'`` (discrete: ``A_i X_i A_i' - X_i``).

    If Q > 0 decreased in every mode, then ``0 > sum tr X_i (A_i'Q + Q A_i) = tr Q S >= 0`` with S
    that sum, a contradiction (X_i is not zero for all i, since S is not).
    """

    kind: ClassVar[str] = "no-common-quadratic"
    # It is a statement about matrices: no motion, with contact or without, is spoken of.
    covers_lost_contact: ClassVar[bool] = True

    # Mode names and the integer matrices L_i with n rows; modes left out have X_i = 0.
    factors: tuple[tuple[str, Matrix], ...]

    @property
    def shows(self) -> Shows:
        """That no common quadratic function exists, which says nothing about stability."""
        return Shows.NO_COMMON_QUADRATIC

    def fits(self, switching: Switching) -> bool:
        """Tell that it always applies: it is a statement about matrices, not about signals."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check names and shapes."""
        names = [name for name, _ in self.factors]
        if not set(names) <= {mode.name for mode in system.modes} or len(set(names)) < len(names):
            return "the factors are not those of modes"
        if any(len(L) != system.order or len(set(map(len, L))) != 1 for _, L in self.factors):
            return f"a factor does not have {system.order} rows of one length"
        if self._common(system) is None:
            return "the numbers of the modes are too large to check"
        return None

    def _common(self, system: SwitchedSystem) -> int | None:
        modes = {mode.name: mode.A.denominator**2 for mode in system.modes}
        return common_denominator(modes[name] for name, _ in self.factors)

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield the sum."""
        n = system.order
        modes = {mode.name: mode for mode in system.modes}
        total = [[0] * n for _ in range(n)]
        common = self._common(system)
        assert common is not None
        for name, L in self.factors:
            weight = common // modes[name].A.denominator ** 2
            total = add(total, _term(modes[name], L, system.time), weight)
        yield "the sum over the modes is not positive definite", total

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the impossibility."""
        condition = "A'Q + QA < 0" if system.time is Time.CONTINUOUS else "A'QA < Q"
        return (
            f"No positive definite Q satisfies {condition} for all modes: a common quadratic "
            "Lyapunov function does not exist. This alone says nothing about stability."
        )


def _term(mode: Mode, L: Matrix, time: Time) -> list[list[int]]:
    """Return ``denominator^2`` times ``A X + X A'`` (or ``A X A' - X``) with ``X = L L'``."""
    N, q = mode.A.numerators, mode.A.denominator
    X = [[sum(map(mul, a, b)) for b in L] for a in L]
    NX = multiply(N, X)
    if time is Time.CONTINUOUS:
        return scaled(add(NX, transpose(NX)), q)
    return add(multiply(NX, transpose(N)), X, -q * q)
