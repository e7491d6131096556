"""Three admittances in one step, against the step of one axis and exact arithmetic."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.controllers.axes_law import build_axes_law, lacks_axes
from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.replica import step
from tests.exporters.programs import LAWS

ONE = LAWS["inertia"]
RNG = np.random.default_rng(3)


def given(law, count, **values):
    made = {v.name: np.zeros(count, np.float32) for v in law.values}
    return made | {name: np.asarray(v, np.float32) for name, v in values.items()}


@pytest.mark.parametrize("axis", [1, 2, 3])
def test_each_axis_moves_as_one_alone_does(axis):
    """Every bit of the velocity is that of the law which has the motor loop."""
    law, count = build_axes_law(ONE), 200
    mode = RNG.integers(0, 2, count).astype(np.uint32)
    torque, velocity = RNG.normal(0, 0.3, count), RNG.normal(0, 0.1, count)
    three = step(
        law,
        mode,
        given(law, count, **{f"torque_{axis}": torque, f"velocity_{axis}": velocity}),
    )
    one = step(ONE, mode, given(ONE, count, torque=torque, velocity=velocity))
    assert three.valid.all()
    assert one.valid.all()
    np.testing.assert_array_equal(three.states[f"velocity_{axis}"], one.states["velocity"])
    np.testing.assert_array_equal(three.outputs[f"moves_{axis}"], one.states["velocity"])
    others = {1, 2, 3} - {axis}
    assert not any(three.outputs[f"moves_{other}"].any() for other in others)


def test_a_lasting_torque_ends_at_the_velocity_that_the_damping_leaves():
    """``F / Bt``: 0.215 N m over 2.15 N m s/rad."""
    law = build_axes_law(ONE)
    a, b = (law.coefficient[name].of(0) for name in ("a", "b"))
    assert float(b / (1 - a)) == pytest.approx(1 / 2.15, rel=1e-5)
    states = given(law, 1, torque_2=[float(to_float32(Fraction("0.215")))])
    for _ in range(60):
        states |= step(law, np.zeros(1, np.uint32), states).states
    assert float(states["velocity_2"][0]) == pytest.approx(0.1, rel=1e-5)


@pytest.mark.parametrize("name", ["torque_1", "velocity_3"])
@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 1.1e6])
def test_what_no_sensor_gives_is_refused(name, wrong):
    law = build_axes_law(ONE)
    values = given(law, 1, **{name: [wrong]}, velocity_1=[0.5]) | given(law, 1)
    values[name] = np.float32([wrong])
    values["velocity_2"] = np.float32([0.25])
    result = step(law, np.zeros(1, np.uint32), values)
    assert not result.valid[0]
    assert not any(output.any() for output in result.outputs.values())
    assert float(result.states["velocity_2"][0]) == 0.25


def test_a_mode_that_there_is_not_is_refused():
    law = build_axes_law(ONE)
    assert not step(law, np.uint32([2]), given(law, 1)).valid[0]


@pytest.mark.parametrize(
    ("shape", "lack"),
    [
        ("static", "no controller has a virtual inertia"),
        ("force and position", "no controller has a virtual inertia"),
        ("filter and spring", "spring"),
        ("mixed", "force control"),
        ("inertia", ""),
    ],
)
def test_what_three_axes_do_not_have_is_said(shape, lack):
    found = lacks_axes(LAWS[shape])
    assert lack in found
    assert bool(found) == bool(lack)
