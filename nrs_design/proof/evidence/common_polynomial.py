"""One homogeneous polynomial Lyapunov function of degree 2d for all modes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import comb
from typing import Any, ClassVar, Self

from nrs_design.proof.evidence.common_quadratic import decay_claim
from nrs_design.proof.evidence.fields import (
    Matrix,
    matrix_fields,
    read_dyadic,
    read_integer,
    read_integers,
    read_ratio,
)
from nrs_design.proof.evidence.function import AbstractFunction, is_square
from nrs_design.proof.exact import (
    MAX_WORK,
    IntegerMatrix,
    add,
    bit_length,
    lyapunov_decrease,
    lyapunov_factor,
    stein_decrease,
    stein_factor,
)
from nrs_design.proof.lift import derivative_lift, power_lift, vanishes
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem

MAX_DEGREE = 64
MAX_MONOMIALS = 120


@dataclass(frozen=True, slots=True)
class CommonPolynomial(AbstractFunction):
    """``V(x) = z' Q z`` with z the monomials of degree d decreases in every mode.

    Since ``z' N_i z = 0`` for all x, mode i satisfies ``V' = z'(L'Q + QL - N_i) z`` with the
    lifted mode L, and ``V' < -2 d alpha V`` if ``-(L'Q + QL + 2 d alpha Q) + N_i > 0``.
    """

    kind: ClassVar[str] = "common-polynomial"
    bounds_at_once: ClassVar[bool] = True
    covers_mixtures: ClassVar[bool] = True

    degree: int  # The d: V has degree 2d
    # Shape (K, K). Numerators of the Gram matrix, in the monomials as `lift.monomials` orders them.
    Q: Matrix
    denominator_log2: int  # Q is these numerators over two to this power
    # Shape (K, K). One N_i per mode, over the same denominator, times the positive integer that
    # clears the denominators of the decrease: that of the mode times that of ``2 d alpha`` times
    # it, or in discrete time that of the mode to the power 2d times that of ``rho^d`` squared.
    vanishing: tuple[Matrix, ...]
    rate: Fraction  # alpha in 1/s, or rho per step

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """False: V need not be convex, but a joint spectral radius is that of the convex hull."""
        return False

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check shapes, the sign of the rate, and that each N vanishes identically."""
        n, d = system.order, self.degree
        if not 1 <= d <= MAX_DEGREE // 2:
            return f"degree {2 * d} is not between 2 and {MAX_DEGREE}"
        size = comb(n + d - 1, d)
        if size > MAX_MONOMIALS:
            return f"there are more than {MAX_MONOMIALS} monomials of degree {d}"
        if len(self.vanishing) != len(system.modes):
            return "there is not one vanishing form for each mode"
        if not all(is_square(M, size) for M in (self.Q, *self.vanishing)):
            return f"a form is not a {size} x {size} matrix"
        if any(_is_too_long(mode, d, self.Q, system.time) for mode in system.modes):
            return "its numbers are too large to check"
        if not all(vanishes(N, n, d) for N in self.vanishing):
            return "a form that must vanish does not"
        return self.find_rate_misfit(system.time)

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield Q and the decrease in every mode."""
        yield "Q is not symmetric and positive definite", self.Q
        for mode, N in zip(system.modes, self.vanishing, strict=True):
            decrease = lifted_decrease(mode, self.degree, self.Q, self.rate, system.time)
            failure = f"V does not decrease at the claimed rate in mode {mode.name}"
            yield failure, add(decrease, N)

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution."""
        degree = 2 * self.degree
        norm = f"where |x|^{degree} is a positive definite form of degree {degree} in x"
        return decay_claim(system, self.rate, norm)

    def spread(self, merged: SwitchedSystem, system: SwitchedSystem) -> Self:
        """Repeat the vanishing form of every mode for its equals."""
        forms = {mode.A: N for mode, N in zip(merged.modes, self.vanishing, strict=True)}
        return replace(self, vanishing=tuple(forms[mode.A] for mode in system.modes))

    def to_fields(self) -> dict[str, Any]:
        """Return the degree, Q, the vanishing forms and the rate."""
        return {
            "degree": 2 * self.degree,
            "Q": matrix_fields(self.Q, self.denominator_log2),
            "vanishing": [[list(row) for row in N] for N in self.vanishing],
            "rate": str(self.rate),
        }

    @classmethod
    def from_fields(cls, fields: Mapping[str, Any], system: SwitchedSystem) -> Self:
        """Read the degree, Q, the vanishing forms and the rate."""
        half, odd = divmod(read_integer(fields["degree"]), 2)
        if odd:
            raise ValueError("the degree is odd")
        Q, denominator_log2 = read_dyadic(fields["Q"])
        vanishing = tuple(read_integers(N) for N in fields["vanishing"])
        return cls(half, Q, denominator_log2, vanishing, read_ratio(fields["rate"]))


def _is_too_long(mode: Mode, degree: int, Q: IntegerMatrix, time: Time) -> bool:
    """Tell whether the numbers of the decrease are too large, before they are formed."""
    factors = 1 if time is Time.CONTINUOUS else 2 * degree
    bits = bit_length(Q) + factors * bit_length(mode.A.numerators)
    return len(Q) ** 3 * bits > MAX_WORK


def lifted_decrease(
    mode: Mode, degree: int, Q: IntegerMatrix, rate: Fraction, time: Time
) -> list[list[int]]:
    """Return ``-(L'Q + QL + 2 d alpha Q)`` (or ``rho^2d Q - L'QL``), times `lifted_factor`.

    Parameters
    ----------
    mode : Mode
        Whose matrix is lifted.
    degree : int
        The d of the monomials.
    Q : integer matrix
        Of the form on the monomials.
    rate : Fraction
        The alpha or rho.
    time : Time
        Which of the two forms.
    """
    N, denominator = mode.A.numerators, mode.A.denominator
    if time is Time.CONTINUOUS:
        return lyapunov_decrease(derivative_lift(N, degree), denominator, Q, degree * rate)
    return stein_decrease(power_lift(N, degree), denominator**degree, Q, rate**degree)


def lifted_factor(mode: Mode, degree: int, rate: Fraction, time: Time) -> int:
    """Return the positive integer that `lifted_decrease` multiplies with.

    The vanishing forms of a certificate are added to the multiplied decrease. Whatever they are
    multiplied with, they vanish, so no proof depends on it; only a search does.

    Parameters
    ----------
    mode, degree, rate, time
        As for `lifted_decrease`.
    """
    if time is Time.CONTINUOUS:
        return lyapunov_factor(mode.A.denominator, degree * rate)
    return stein_factor(mode.A.denominator**degree, rate**degree)
