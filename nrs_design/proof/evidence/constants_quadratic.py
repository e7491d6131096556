"""A quadratic function that depends on parameters that are unknown but constant."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.proof.evidence.abstract import AbstractFunction, find_odd_form, is_square
from nrs_design.proof.evidence.fields import Matrix, rate_words
from nrs_design.proof.exact import IntegerMatrix, add, multiply, scaled, transpose
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import constants_words
from nrs_design.proof.system import SwitchedSystem


@dataclass(frozen=True, slots=True)
class ConstantsQuadratic(AbstractFunction):
    """``V(x) = x' P(p) x`` decreases in every mode, for every constant value of the parameters.

    The modes of a set in `Switching.fixed_ends` are one mode A at the corners v of the parameters,
    ``A(p) = sum_v w_v(p) A_v``, with the same weights in every set, and ``P(p) = sum_v w_v(p) P_v``
    has these weights too. For every set there are two matrices F and G, the same at all corners.
    With y for x' (discrete time: x+), ``y - A x = 0`` may be added to what V does, times
    ``2 (x'F + y'G)`` (de Oliveira, Bernussou and Geromel 1999; with F: Geromel and others 2007):

    - continuous: ``[[-(FA + A'F') - 2 alpha P, F - P - A'G'], [*, G + G']] > 0``, which is
      ``-2 x'PA x - 2 alpha x'P x`` at ``y = A x``;
    - discrete: ``[[rho^2 P - (FA + A'F'), F - A'G'], [*, G + G' - P]] > 0``, which is
      ``rho^2 x'P x - (A x)'P A x`` there.

    Both are affine in A and P together. So what holds at all corners, with the same F and G, holds
    at A(p) and P(p) for every p. Modes at one p share P(p), whatever parameters jump beside: they
    and their convex combinations decrease one function, under arbitrary switching.
    """

    kind: ClassVar[str] = "constants-quadratic"
    bounds_at_once: ClassVar[bool] = True

    functions: tuple[Matrix, ...]  # P at the corners of the parameters, in the order of a set
    # Numerators of F and G, shape (n, n), for each set of `fixed_ends`
    multipliers: tuple[tuple[Matrix, Matrix], ...]
    denominator_log2: int  # All of them are over two to this power
    rate: Fraction  # alpha in 1/s, or rho per step

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: the function is convex."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check corners, shapes and rate; the sets are those of the system."""
        sets = system.switching.fixed_ends
        if not sets:
            return "no parameter of the system is constant"
        if any(len(corners) != len(self.functions) for corners in sets):
            return "there is not one function for each corner of the constant parameters"
        if len(self.multipliers) != len(sets):
            return "there are not two multipliers for each mode and its corners"
        n = system.order
        odd = (find_odd_form(P, self.denominator_log2, n) for P in self.functions)
        if (fault := next(filter(None, odd), None)) is not None:
            return fault
        if not all(is_square(M, n) for pair in self.multipliers for M in pair):
            return f"a multiplier is not a {n} x {n} matrix"
        return self.find_rate_misfit(system.time)

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield the function at every corner, and the decrease of every mode there."""
        for index, P in enumerate(self.functions):
            yield f"P at corner {index + 1} is not symmetric and positive definite", P
        modes = {mode.name: mode for mode in system.modes}
        for corners, (F, G) in zip(system.switching.fixed_ends, self.multipliers, strict=True):
            for name, P in zip(corners, self.functions, strict=True):
                form = self._decrease(modes[name], P, F, G, system.time)
                yield f"V does not decrease in mode {name}", form

    def _decrease(self, mode: Mode, P: Matrix, F: Matrix, G: Matrix, time: Time) -> list[list[int]]:
        """Form what must be positive, times the denominators of mode and rate."""
        N, d, p, q = mode.A.numerators, mode.A.denominator, *self.rate.as_integer_ratio()
        FN, NG = multiply(F, N), multiply(transpose(N), transpose(G))
        own, doubled = add(FN, transpose(FN)), add(G, transpose(G))
        if time is Time.CONTINUOUS:
            first = add(scaled(own, -q), P, -2 * p * d)
            mixed = scaled(add(scaled(add(F, P, -1), d), NG, -1), q)
            last = scaled(doubled, d * q)
        else:
            first = add(scaled(P, p * p * d), own, -q * q)
            mixed = scaled(add(scaled(F, d), NG, -1), q * q)
            last = scaled(add(doubled, P, -1), d * q * q)
        upper = [[*a, *b] for a, b in zip(first, mixed, strict=True)]
        return upper + [[*a, *b] for a, b in zip(transpose(mixed), last, strict=True)]

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution."""
        continuous = system.time is Time.CONTINUOUS
        law, decay = ("x' = A x", "exp(-alpha t)") if continuous else ("x+ = A x", "rho^t")
        return (
            f"For every constant value of {constants_words(system.switching)}, every solution of "
            f"{law}, switching arbitrarily among the modes at that value, satisfies |x(t)| <= "
            f"{decay} |x(0)| with {rate_words(self.rate, system.time)}, in a norm "
            "|x| = sqrt(x' P x) with P a weighted mean of those at the corners of the ranges."
        )
