"""How far the cost of the gains that ship is above the least one within their bounds, proved.

The cost is the finite sum that is minimized, `nrs_design.design.impedance_optimum.NODES`
frequencies, and not the integral that it stands for. Its numbers in double precision are taken as
they are; from there on all is exact, or in balls: `nrs_design.design.least_cost`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.design.impedance_optimum import NODES, ImpedanceProblem, optimize_impedance
from nrs_design.design.least_cost import Frequency, cost_at_most, least_cost
from nrs_design.proof.bounds import upper

# How near the bound shall come to the cost that a search has found, and how many boxes it may take.
NEARLY, MOST = Fraction(1, 10**6), 1500

_Complex = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class CostBound:
    """Two bounds: on the cost that ships, and on the least cost within the bounds of the gains."""

    above: Fraction  # The cost of the gains that ship is at most this
    below: Fraction  # No gains within their bounds, stable or not, cost less
    boxes: int  # That were looked at
    reached: bool  # Whether the search came as near as it was asked to
    goals: bool  # Whether the gains that ship had goals to meet, which the bound leaves out

    @property
    def gap(self) -> Fraction:
        """By how much the gains that ship cost more than the best, at most."""
        return self.above - self.below

    @property
    def text(self) -> str:
        """The gap in words, rounded up."""
        ended = "" if self.reached else ", where the search ended"
        what = "least cost without goals" if self.goals else "global optimum"
        return f"{what} within {upper(self.gap, 2)}, {self.boxes} boxes{ended}"


def bound_cost(
    problem: ImpedanceProblem, Mt: float, Bt: float, *, goals: bool = False, most: int = MOST
) -> CostBound:
    """Bound the least cost over all gains within their bounds; the gains given are those that ship.

    The problem has no part for transparency or accuracy. `goals`: the gains had goals to meet; at
    most so many boxes are looked at.
    """
    frequencies = [*_frequencies(problem)]
    weights = Fraction(problem.weight_displayed), Fraction(problem.weight_sensitivity)
    enough = Fraction(optimize_impedance(problem).cost) - NEARLY
    least = least_cost(
        frequencies,
        weights,
        (Fraction(problem.mass_bounds[0]), Fraction(problem.mass_bounds[1])),
        (Fraction(problem.damping_bounds[0]), Fraction(problem.damping_bounds[1])),
        enough=enough,
        most=most,
    )
    above = cost_at_most(frequencies, weights, Fraction(Mt), Fraction(Bt))
    return CostBound(above, least.below, least.boxes, least.below >= enough, goals)


def why_no_bound(problem: ImpedanceProblem) -> str:
    """Say why a least cost is not bounded; nothing where it is."""
    if problem.mass_bounds[0] == problem.mass_bounds[1] and (
        problem.damping_bounds[0] == problem.damping_bounds[1]
    ):
        return "Mt and Bt are given"
    return ""


def _frequencies(problem: ImpedanceProblem) -> Iterator[Frequency]:
    """Yield what the cost takes at each of its frequencies, exactly."""
    motion, contact = problem.loop.motion, problem.loop.contact.impedance
    for i in range(NODES):
        omega = Fraction(problem.bandwidth) * (2 * i + 1) / (2 * NODES)

        def at(polynomial: Sequence[float], omega: Fraction = omega) -> _Complex:
            return _at(polynomial, omega)

        above, below = (
            _times(at(p), at(q))
            for p, q in zip((motion.numerator, motion.denominator), contact, strict=True)
        )
        forward = _over(above, below)
        filtered = _over(forward, at(problem.loop.lags))
        yield Frequency(
            omega,
            Fraction(problem.loop.Kt) / omega,
            *filtered,
            Fraction(problem.desired) ** 2 / (forward[0] ** 2 + forward[1] ** 2),
        )


def _at(polynomial: Sequence[float], omega: Fraction) -> _Complex:
    """Return the value at ``j omega``, highest power first."""
    real = imag = Fraction(0)
    for c in polynomial:
        real, imag = Fraction(float(c)) - imag * omega, real * omega
    return real, imag


def _times(a: _Complex, b: _Complex) -> _Complex:
    return a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]


def _over(a: _Complex, b: _Complex) -> _Complex:
    real, imag = _times(a, (b[0], -b[1]))
    size = b[0] ** 2 + b[1] ** 2
    return real / size, imag / size
