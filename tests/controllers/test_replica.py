"""One step in single precision: every kind of operation by hand, and what is not valid."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.controllers.replica import step
from nrs_design.controllers.step_analysis import check_range
from tests.exporters.programs import LAWS

HUGE = Fraction(2) ** 100
X, Y = (Value(name, name, "1", HUGE, "an input") for name in "xy")
THIRD = Coefficient("c", "", "1", (Fraction(float(np.float32(1 / 3))),))


def computed(kind, left, x, y=0.0):
    """Return what one operation makes of x, or of x and y."""
    made = (Operation("z", kind, left, "x"),)
    law = StepLaw(("one",), (X, Y), (), (THIRD,), made, {"z": "z"}, {}, {"z": "1"})
    given = {"x": np.float32([x]), "y": np.float32([y])}
    result = step(law, np.zeros(1, np.uint32), given)
    return result.outputs["z"][0] if result.valid[0] else None


THIRD32 = np.float32(1 / 3)


@pytest.mark.parametrize(
    ("kind", "left", "x", "y", "expected"),
    [
        ("add", "y", 1e8, 1.0, 1e8),
        ("subtract", "y", 1.0, 4.0, 3.0),
        ("multiply", "c", 3.0, 0.0, THIRD32 * np.float32(3)),
        ("saturate", "c", -3.0, 0.0, -THIRD32),
        # Refused as inputs.
        ("add", "y", np.nan, 1.0, None),
        ("add", "y", 1.0, np.inf, None),
    ],
)
def test_every_operation_rounds_once(kind, left, x, y, expected):
    found = computed(kind, left, x, y)
    assert (found is None) if expected is None else found == np.float32(expected)


@pytest.mark.parametrize("shape", sorted(LAWS))
def test_single_precision_stays_finite_within_the_limits(shape):
    """At corners of the inputs and states: what `check_range` says holds."""
    law = LAWS[shape]
    check_range(law)
    rng = np.random.default_rng(41)
    given = {
        v.name: np.float32(float(v.limit)) * rng.choice([-1, 1], 200).astype(np.float32)
        for v in law.values
    }
    result = step(law, rng.integers(0, len(law.modes), 200).astype(np.uint32), given)
    assert result.valid.all()
    for numbers in (*result.outputs.values(), *result.states.values()):
        assert np.isfinite(numbers).all()


def test_a_mode_that_there_is_not_is_refused():
    law = LAWS["inertia"]
    given = {v.name: np.zeros(3, np.float32) for v in law.values}
    assert step(law, np.uint32([1, 2, 2**32 - 1]), given).valid.tolist() == [True, False, False]
    without = replace(law, modes=("insertion",), coefficients=tuple(_first(law)))
    assert step(without, np.uint32([0, 1, 2]), given).valid.tolist() == [True, False, False]


def test_an_invalid_step_keeps_the_bits_of_the_state():
    law = LAWS["inertia"]
    given = {v.name: np.zeros(3, np.float32) for v in law.values}
    given["velocity"] = np.array([0x7F800001, 0xFFC12345, 0], np.uint32).view(np.float32)
    result = step(law, np.array([0, 1, 2], np.uint32), given)
    assert not result.valid.any()
    assert (result.states["velocity"].view(np.uint32) == given["velocity"].view(np.uint32)).all()
    assert not result.outputs["command"].any()


def _first(law):
    return (replace(c, values=c.values[:1]) for c in law.coefficients)
