"""A quadratic function that depends on one unknown but constant parameter."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import ClassVar

from nrs_design.proof.evidence.abstract import AbstractFunction, find_odd_form
from nrs_design.proof.evidence.fields import Matrix, rate_words
from nrs_design.proof.exact import IntegerMatrix, add, lyapunov_decrease, scaled
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem


@dataclass(frozen=True, slots=True)
class ParameterQuadratic(AbstractFunction):
    """``V(x) = x' Q(p) x`` with ``Q(p) = (1-p) Q_low + p Q_high`` decreases for all p in [0, 1].

    With ``M_ab = -(A_a'Q_b + Q_b A_a + 2 alpha Q_b)``, the decrease at p is
    ``(1-p)^2 M_ll + p(1-p) (M_lh + M_hl) + p^2 M_hh``, positive definite if the three
    matrices ``M_ll``, ``M_hh`` and ``M_lh + M_hl`` are. The same for every pair of ends.
    """

    kind: ClassVar[str] = "parameter-quadratic"
    bounds_at_once: ClassVar[bool] = True

    # low, high: shape (n, n). Numerators of Q at the two ends of the parameter.
    low: Matrix
    high: Matrix
    denominator_log2: int  # Both are over two to this power
    rate: Fraction  # alpha in 1/s

    @property
    def keeps_bound_in_mixtures(self) -> bool:
        """True: it is for continuous time."""
        return True

    def find_misfit(self, system: SwitchedSystem) -> str | None:
        """Check time, pairs, shapes and rate."""
        if system.time is not Time.CONTINUOUS:
            return "parameter-dependent functions are for continuous time"
        sets = system.switching.fixed_ends
        if not sets or any(len(corners) != 2 for corners in sets):
            return "the modes are not the ends of one constant parameter"
        odd = (find_odd_form(Q, self.denominator_log2, system.order) for Q in (self.low, self.high))
        return next(filter(None, odd), None) or self.find_rate_misfit(system.time)

    def forms(self, system: SwitchedSystem) -> Iterator[tuple[str, IntegerMatrix]]:
        """Yield both functions, and the three conditions of every pair."""
        yield "Q at the low end is not symmetric and positive definite", self.low
        yield "Q at the high end is not symmetric and positive definite", self.high
        modes = {mode.name: mode.A for mode in system.modes}
        rate = self.rate
        for low, high in system.switching.fixed_ends:
            A, B = modes[low], modes[high]
            # Over one denominator and at one rate, all forms have the same `lyapunov_factor`, so
            # the sum of two is that multiple of the sum of the true ones.
            common = lcm(A.denominator, B.denominator)
            at_low, at_high = (
                [
                    lyapunov_decrease(
                        scaled(M.numerators, common // M.denominator), common, Q, rate
                    )
                    for Q in (self.low, self.high)
                ]
                for M in (A, B)
            )
            yield f"V does not decrease in mode {low}", at_low[0]
            yield f"V does not decrease in mode {high}", at_high[1]
            mixed = add(at_low[1], at_high[0])
            yield f"V does not decrease between {low} and {high}", mixed

    def claim_in_scope(self, system: SwitchedSystem) -> str:
        """State the bound on every solution."""
        count = len(system.switching.fixed_ends)
        among = "the one mode" if count == 1 else f"the {count} modes"
        return (
            f"For every constant value of the parameter in its range, every solution of x' = A x, "
            f"switching arbitrarily among {among} at that value, satisfies |x(t)| <= exp(-alpha t) "
            f"|x(0)| with {rate_words(self.rate, system.time)}, in a norm "
            "|x| = sqrt(x' Q x) with Q affine in the parameter."
        )
