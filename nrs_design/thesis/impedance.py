"""Chapters 6.3.1, 6.3.2.1 and 6.4.1: desired impedance and the optimal admittances."""

from __future__ import annotations

from collections.abc import Iterator
from math import log, pi

from nrs_design.design.impedance_optimum import ImpedanceLoop, ImpedanceProblem, optimize_impedance
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.contact import Elastic
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Found, Recomputed
from nrs_design.thesis.interaction import DESIRED

LOOPS = (thesis.PRINTED_LOOP, thesis.EXACT_LOOP)


def results() -> Iterator[Found]:
    """Recompute what is desired, the four optima with either G, and how stiff is too stiff."""
    desired, soft, stiff = DESIRED, float(thesis.SOFT), float(thesis.STIFF)
    yield from (desired, desired / 2, 2 * pi * thesis.BANDWIDTH_IN_HERTZ, soft, stiff)
    yield soft / 0.24**2
    # Stiffness, desired impedance and least Mt of each design.
    for design in (
        (soft, desired, 0.0),
        (soft, desired, 0.01),
        (soft, desired / 2, 0.01),
        (stiff, desired, 0.01),
    ):
        yield from (_optimum(loop, *design) for loop in LOOPS)
    # The natural logarithm in 6.4 weighs the displayed impedance ln 10 times more.
    loop, weight = thesis.EXACT_LOOP, log(10) / 2
    found = (
        *_optimum(loop, soft, desired / 2, 0.01, weight=weight),
        *_optimum(loop, stiff, desired, 0.01, weight=weight),
    )
    yield Recomputed(found, abs(found[1] - 1.04) > 0.01 and abs(found[3] - 2.11) > 0.01)
    yield from (thesis.stiffness_limit(0.01, Bt) for Bt in (1.04, 2.11, 2.15))


def _optimum(
    loop: TransferFunction, stiffness: float, desired: float, least: float, weight: float = 0.5
) -> tuple[float, float]:
    problem = ImpedanceProblem(
        loop=ImpedanceLoop(loop, Elastic(stiffness)),
        desired=desired,
        bandwidth=2 * pi * thesis.BANDWIDTH_IN_HERTZ,
        mass_bounds=(least, 1.0),
        damping_bounds=(0.1, 20.0),
        weight_displayed=weight,
    )
    optimum = optimize_impedance(problem)
    return optimum.Mt, optimum.Bt
