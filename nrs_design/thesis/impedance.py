"""Chapters 6.3.1, 6.3.2.1 and 6.4.1: desired impedance and the optimal admittances."""

from __future__ import annotations

from math import log, pi

from nrs_design.design.impedance import ImpedanceLoop
from nrs_design.design.impedance_optimum import ImpedanceProblem, optimize_impedance
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.contact import Elastic
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import (
    ReproducedValue,
    Tolerance,
    derived,
    misprint,
    reproduced,
)

LOOPS = (("G as in 6.1", thesis.PRINTED_LOOP), ("G exact", thesis.EXACT_LOOP))
ZDES = thesis.TORQUE / thesis.VELOCITY

# Name, section, stiffness, desired impedance, least Mt, printed optimum, with more digits.
DESIGNS = (
    ("soft, Mt free", "6.3.1.1", thesis.SOFT, ZDES, 0.0, ("0", "2.15"), ("0", "2.1514")),
    ("soft, Mt >= 0.01", "6.3.2.1", thesis.SOFT, ZDES, 0.01, ("0.01", "2.15"), ("0.01", "2.1496")),
    (
        "soft, half the impedance",
        "6.3.2.1",
        thesis.SOFT,
        ZDES / 2,
        0.01,
        ("0.01", "1.04"),
        ("0.01", "1.0414"),
    ),
    (
        "stiff, Mt >= 0.01",
        "6.4.1",
        thesis.STIFF,
        ZDES,
        0.01,
        ("0.01", "2.11"),
        ("0.01", "2.1094"),
    ),
)
# Bt, stiffness in use and where, and the limit with its tolerance; Mt = 0.01.
LIMITS = (
    (1.04, "43.0356", "6.3.2.2", "75.9", 0.3),
    (2.11, "61.6608", "6.4.1", "225.6", 0.5),
    (2.15, "43.0356", "6.3.2.2", "232.3", 0.5),
)
_READING = "With the decimal logarithm on a linear grid of frequencies in 6.4."
# Thesis 6.1 cites 1002 +- 568 N/m for surgeons' hands; contact is at 0.24 m.
HAND = tuple(k * 0.24**2 for k in (1002 - 568, 1002 + 568))


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute what is desired, the four optima with either G, and how stiff is too stiff."""
    return (*_goals(), *_optima(), _natural(), *_limits())


def _goals() -> tuple[ReproducedValue, ...]:
    tight = Tolerance(1e-5)
    return (
        reproduced(
            "desired impedance",
            "6.2",
            "2.1486",
            ZDES,
            "N m s/rad",
            tight,
            right="2.14859",
        ),
        reproduced("half of it", "6.3.2.1", "1.0743", ZDES / 2, "N m s/rad", tight),
        reproduced(
            "upper end of the band",
            "6.4",
            "12.57",
            2 * pi * thesis.BANDWIDTH_IN_HERTZ,
            "rad/s",
            Tolerance(5e-4),
        ),
        reproduced("k_soft", "6.3.1.1", "43.0356", float(thesis.SOFT), "N m/rad", tight),
        reproduced("k_stiff", "6.4.1", "61.6608", float(thesis.STIFF), "N m/rad", tight),
        misprint(
            "stiffness behind k_soft",
            "6.3.1.1",
            "752.69",
            float(thesis.SOFT) / 0.24**2,
            "N/m",
            tight,
            right="747.1461",
            note="The section cites the third experiment, then computes with the mean of three.",
            errata=("6.3.1 k_soft",),
        ),
    )


def _optima() -> tuple[ReproducedValue, ...]:
    return tuple(
        reproduced(
            f"Mt, Bt: {name}; {source}",
            section,
            printed,
            _optimum(loop, float(k), desired, least),
            "kg m^2, N m s/rad",
            Tolerance(absolute=2e-3),
            right=right,
            note=_READING,
        )
        for name, section, k, desired, least, printed, right in DESIGNS
        for source, loop in LOOPS
    )


def _natural() -> ReproducedValue:
    """Take the natural logarithm in 6.4, which weighs the displayed impedance ln 10 times more."""
    loop = thesis.EXACT_LOOP
    found = (
        *_optimum(loop, float(thesis.SOFT), ZDES / 2, 0.01, weight=log(10) / 2),
        *_optimum(loop, float(thesis.STIFF), ZDES, 0.01, weight=log(10) / 2),
    )
    return derived(
        "Mt, Bt with the natural logarithm: soft, half the impedance; stiff",
        "6.4",
        found,
        "kg m^2, N m s/rad",
        printed="0.01, 1.04; 0.01, 2.11",
        right=("0.01", "1.0511", "0.01", "2.1242"),
        tolerance=Tolerance(absolute=2e-3),
        holds=abs(found[1] - 1.04) > 0.01 and abs(found[3] - 2.11) > 0.01,
        note="Base and grid are not printed. The natural logarithm misses the prints, the decimal "
        "one meets them.",
        errata=("6.4",),
    )


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


def _limits() -> tuple[ReproducedValue, ...]:
    return tuple(_limit(*entry) for entry in LIMITS)


def _limit(Bt: float, used: str, section: str, right: str, tolerance: float) -> ReproducedValue:
    limit = thesis.stiffness_limit(0.01, Bt)
    hand = (
        f" A surgeon's hand, {HAND[0]:.1f} to {HAND[1]:.1f} N m/rad by the thesis's own figures, "
        "reaches beyond it."
    )
    return derived(
        f"largest stable stiffness, Mt 0.01, Bt {Bt}",
        section,
        limit,
        "N m/rad",
        printed=f"Hurwitz at {used}",
        tolerance=Tolerance(absolute=tolerance),
        right=right,
        note="The thesis states no limit." + (hand if limit < HAND[1] else ""),
    )
