"""One homogeneous polynomial per mode, for transition graphs, stays and resets in discrete time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import comb
from typing import Any, ClassVar, Self

from nrs_design.proof.evidence.abstract import AbstractEvidence, Shows
from nrs_design.proof.evidence.common_polynomial import MAX_DEGREE, MAX_MONOMIALS
from nrs_design.proof.evidence.fields import (
    Matrix,
    read_integer,
    read_integers,
)
from nrs_design.proof.evidence.function import is_square
from nrs_design.proof.evidence.mode_quadratic import (
    ModeQuadratic,
    bound_claim,
    find_odd_switch,
)
from nrs_design.proof.exact import MAX_WORK, IntegerMatrix, add
from nrs_design.proof.lift import power_lift, vanishes
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Reset, Switching
from nrs_design.proof.system import SwitchedSystem


@dataclass(frozen=True, slots=True)
class ModePolynomial(AbstractEvidence):
    """``V_i(x) = z' Q_i z`` with z the monomials of degree d decreases from switch to switch.

    The monomials follow a linear system themselves: ``z(A x) = L z(x)``, at a switch too. What
    `ModeQuadratic` asks of the modes is asked of the lifted ones, at the rate ``rho^d``; and as
    only monomials of some x matter, a form that vanishes identically may be added to each decrease.
    """

    kind: ClassVar[str] = "mode-polynomial"
    allows_unequal_modes: ClassVar[bool] = True
    attains_rate: ClassVar[bool] = True

    degree: int  # The d: every V_i has degree 2d
    # The Q_i, in the monomials as `lift.monomials` orders them, with the rate ``rho``.
    quadratic: ModeQuadratic
    # For each decrease, in the order of `ModeQuadratic.decreases`, integers N with ``z' N z = 0``
    # for all x.
    vanishing: tuple[Matrix, ...]

    @property
    def shows(self) -> Shows:
        """Stability."""
        return Shows.STABILITY

    @property
    def leaving(self) -> tuple[str, ...]:
        """Modes in which V_i need not decrease, because they have a longest dwell time."""
        return self.quadratic.leaving

    @property
    def lifted(self) -> ModeQuadratic:
        """The Q_i as evidence for the lifted modes, up to forms that vanish."""
        return replace(self.quadratic, rate=self.quadratic.rate**self.degree)

    def fits(self, switching: Switching) -> bool:
        """Tell whether every mode in force is one of the modes."""
        return self.quadratic.fits(switching)

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: its bound has a constant factor anyway."""
        return True

    def proved_rate(self, system: SwitchedSystem) -> Fraction:
        """Return the claimed rate."""
        return self.quadratic.rate

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check shapes, rate and stays, and that each N vanishes identically."""
        if system.time is not Time.DISCRETE:
            return "polynomials for each mode are for discrete time"
        misfit = find_odd_switch(system) or self.quadratic.find_rate_misfit(system.time)
        if misfit := misfit or find_large_lift(system, self.degree):
            return misfit
        lifted = lift_system(system, self.degree)
        if misfit := self.lifted.find_misfit(lifted):
            return misfit
        sizes = {mode.name: mode.A.shape[0] for mode in system.modes}
        modes = self.lifted.decreasing_modes(lifted)
        if len(self.vanishing) != len(modes):
            return "there is not one vanishing form for each decrease"
        for mode, N in zip(modes, self.vanishing, strict=True):
            if not is_square(N, mode.A.shape[0]):
                return f"a form that must vanish has the wrong size for mode {mode.name}"
            if not vanishes(N, sizes[mode.name], self.degree):
                return "a form that must vanish does not"
        return None

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield every Q_i, and every decrease with its form that vanishes."""
        for name, Q in self.quadratic.functions:
            yield f"Q of mode {name} is not symmetric and positive definite", Q
        decreases = self.lifted.decreases(lift_system(system, self.degree))
        for (failure, decrease), N in zip(decreases, self.vanishing, strict=True):
            yield failure, add(decrease, N)

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution."""
        return bound_claim(system, self.quadratic.rate)

    def to_fields(self) -> dict[str, Any]:
        """Return the degree, the functions, the vanishing forms and the rate."""
        return {
            "degree": 2 * self.degree,
            **self.quadratic.to_fields(),
            "vanishing": [[list(row) for row in N] for N in self.vanishing],
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the degree, the functions, the vanishing forms and the rate."""
        half, odd = divmod(read_integer(fields["degree"]), 2)
        if odd:
            raise ValueError("the degree is odd")
        vanishing = tuple(read_integers(N) for N in fields["vanishing"])
        return cls(half, ModeQuadratic.from_fields(fields, system), vanishing)


def find_large_lift(system: SwitchedSystem, degree: int) -> str | None:
    """Say why a system is not lifted to the monomials of a degree, or None."""
    if not 1 <= degree <= MAX_DEGREE // 2:
        return f"degree {2 * degree} is not between 2 and {MAX_DEGREE}"
    size = max(comb(mode.A.shape[0] + degree - 1, degree) for mode in system.modes)
    if size > MAX_MONOMIALS:
        return f"there are more than {MAX_MONOMIALS} monomials of degree {degree}"
    matrices = [mode.A for mode in system.modes] + [reset.map for reset in system.switching.resets]
    numbers = [v for M in matrices for row in (*M.numerators, (M.denominator,)) for v in row]
    if size**3 * degree * max(map(int.bit_length, numbers)) > MAX_WORK:
        return "the numbers are too large to lift"
    return None


def lift_system(system: SwitchedSystem, degree: int) -> SwitchedSystem:
    """TRUSTED: return the system of the monomials of a degree, in discrete time.

    Parameters
    ----------
    system : SwitchedSystem
        Discrete time; its switches fit its modes.
    degree : int
        The d.
    """
    modes = tuple(Mode(mode.name, _lift(mode.A, degree)) for mode in system.modes)
    resets = tuple(
        Reset(reset.source, reset.target, _lift(reset.map, degree))
        for reset in system.switching.resets
    )
    states = tuple(f"z{k + 1}" for k in range(max(mode.A.shape[0] for mode in modes)))
    switching = replace(system.switching, resets=resets)
    return system.with_modes(modes, states, switching)


def _lift(A: RationalMatrix, degree: int) -> RationalMatrix:
    rows = power_lift(A.numerators, degree)
    return RationalMatrix(tuple(map(tuple, rows)), A.denominator**degree)
