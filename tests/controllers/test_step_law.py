"""The list of operations: how often its terms are rounded, counted by hand, and its limits.

`tests/oracle` holds the loops that are made of it against the pages.
"""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws import (
    Admittance,
    IntegralForce,
    PositionControl,
    ProportionalForce,
)
from nrs_design.controllers.parts import DEFAULT_LIMIT
from nrs_design.controllers.sensor import LowPass
from nrs_design.controllers.step_law import StepFrame, StepLimits, build_law
from tests.controllers.roundings import term_counts

PERIOD, IDLE = Fraction(1, 500), round_float32(Fraction("0.96"))
MOVING = Admittance(Fraction(1, 128), Fraction(17, 8))
SPRUNG, STATIC = replace(MOVING, Kt=Fraction(1, 2)), replace(MOVING, Mt=Fraction(0))
FORCE, POSITION = ProportionalForce(Fraction(1, 64)), PositionControl()
PI = IntegralForce(Fraction(1, 64), Fraction(1, 2))


def law_of(*laws, order=0, limits=None):
    low_pass = LowPass(order, Fraction(200)).discretize(PERIOD) if order else None
    frame = StepFrame(Fraction(10**5), Fraction(10**6), low_pass, limits or StepLimits())
    discrete = {f"law-{i}": law.discretize(PERIOD, "exact") for i, law in enumerate(laws)}
    return build_law(frame, discrete, IDLE)


# The numbers that docs/certificates/rounding.md explains.
MOTION = {"Kp e": 2, "D (e - e before)": 3}
MOVED = MOTION | {"e": 1, "T (v - vm)": 2}
PLACED = MOTION | {"X": 1, "theta": 1}
FILTERED = {0: {"F": 1}, 1: {"p x1": 2, "q F": 3}, 2: {"p x2": 2, "q p x1": 4, "q q F": 5}}


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("law", [MOVING, STATIC, SPRUNG, replace(SPRUNG, Mt=Fraction(0))])
def test_roundings_of_an_admittance(law, order):
    """A lag is two products and a sum, a spring a difference, a product and a sum."""
    more = 1 + (law.Kt != 0) + (law.Mt != 0)
    wanted = MOVED | {f"b {name}": count + more for name, count in FILTERED[order].items()}
    wanted |= {"a vm": 2} if law.Mt else {}
    wanted |= {"b Kt r": 4 + (law.Mt != 0), "T v": 1} if law.Kt else {}
    lags = {name: n for i in range(1, order + 1) for name, n in FILTERED[i].items()}
    assert term_counts(law_of(law, order=order)) == wanted | lags


def test_roundings_of_force_control():
    """The force: read, lack, product, the sum with X, and the difference from the angle."""
    law = law_of(POSITION, FORCE)
    assert term_counts(law, 0) == MOTION | {"e": 1}
    assert term_counts(law, 1) == PLACED | {"Kp F": 5, "Kp Fd": 4}


def test_roundings_of_a_mixture():
    """What is idle is a product; products with zero and one round nothing."""
    law = law_of(POSITION, FORCE, SPRUNG, PI)
    idle = {"d r": 1, "d vm": 1}
    wanted = (
        MOTION | idle | {"e": 1, "g w": 1},
        PLACED | idle | {"w": 3, "Kp F": 6, "Kp Fd": 5, "g w": 1},
        PLACED | {"(r + w)": 3, "a vm": 2, "b F": 4, "b Kt r": 4, "T (v - vm)": 2} | {"g w": 1},
        PLACED | idle | {"w": 1, "Kp F": 6, "Kp Fd": 5, "Ki_T F": 4, "Ki_T Fd": 3},
    )
    assert [term_counts(law, mode) for mode in range(4)] == [*wanted]


@pytest.mark.parametrize("laws", [(MOVING,), (POSITION, FORCE), (POSITION, SPRUNG)])
def test_limits(laws):
    """Angles are refused beyond theirs; command and velocity saturate, which rounds nothing."""
    limits = StepLimits(Fraction(1, 2), Fraction(1, 8), Fraction(4000))
    plain, limited = law_of(*laws), law_of(*laws, limits=limits)
    assert term_counts(limited) == term_counts(plain)
    assert plain.outputs == {"command": "command"}
    assert limited.outputs == {"command": "limited_command"}
    assert limited.coefficient["command_limit"].values == (4000,)
    assert ("velocity_limit" in limited.coefficient) == any(law in laws for law in (MOVING, SPRUNG))
    kept = {value.name: value.limit for value in limited.values}
    angles = kept.keys() & {"angle", "position", "reference", "offset", "integral"}
    assert {kept[name] for name in angles} == {Fraction(1, 2)}
    assert kept["error_before"] == (1 if laws == (MOVING,) else 2 * DEFAULT_LIMIT)
    assert kept["torque"] == DEFAULT_LIMIT
