from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.robot.models.geometry import PoseError
from nrs_design.robot.simulation.experiment import COORDINATE, Experiment, thesis_experiments

# Of the equations, with the 0.0571 rad/s of 4.33c and 4.37 to 4.39 taken literally.
SLOW = np.sin(0.0571 * 20)


@pytest.mark.parametrize(
    ("controllers", "moved", "times", "values", "duration"),
    [
        (("computed-torque",), "d", (0, 10, 12.5, 15, 17.5), (0, 0, 0.05, 0, -0.05), 20),
        (("independent-joint", "balanced"), "d", (30,), (0.05 * SLOW,), 120.04),
        (("computed-torque", "independent-joint"), "phi", (3, 12.5, 17.5), (0, 15, -15), 20),
        (("computed-torque", "independent-joint"), "psi", (3, 12.5, 17.5), (0, 20, -20), 20),
        (("balanced",), "phi", (30,), (15 * SLOW,), 120.04),
        (("balanced",), "psi", (30,), (20 * SLOW,), 120.04),
    ],
)
def test_motions_of_the_thesis(tilted, controllers, moved, times, values, duration):
    """4.20 to 4.22, 4.33 to 4.35, and 4.37 to 4.39; angles in deg."""
    for controller in controllers:
        (one,) = (e for e in thesis_experiments(tilted, controller) if e.coordinate == moved)
        depth = 0.2 if moved == "d" or controller == "balanced" else 0.15
        swing = np.zeros((len(times), 3))
        swing[:, COORDINATE[moved]] = values if moved == "d" else np.radians(values)
        pose = one.motion(np.array(times))[0]
        assert pose == pytest.approx(np.add(swing, (0, 0, depth)), abs=1e-12)
        assert one.duration == pytest.approx(duration, abs=0.01)


def test_a_period_of_ones_own(tilted):
    for controller in ("computed-torque", "independent-joint", "balanced"):
        lengths = {one.duration for one in thesis_experiments(tilted, controller, 4.0)}
        assert lengths == {14.0}


def test_another_workspace_scales_the_motions(tilted):
    small = replace(tilted, workspace=replace(tilted.workspace, phi=0.1, d=(0.16, 0.22)))
    depth, phi, _ = thesis_experiments(small, "computed-torque")
    assert [one.motion(np.array([12.5]))[0][0].tolist() for one in (depth, phi)] == [
        pytest.approx([0, 0, 0.22]),
        pytest.approx([0.1, 0, 0.16]),
    ]


@given(moved=st.sampled_from(["d", "phi", "psi"]), time=st.floats(10.01, 14.9))
def test_velocity_and_acceleration_are_derivatives(moved, time):
    experiment = Experiment(moved, (0.01, 0.02, 0.2), 0.04, 1.3)
    h = 1e-4
    (before, now, after), (_, v, _), (_, _, _) = experiment.motion(
        np.array([time - h, time, time + h])
    )
    a = experiment.motion(np.array([time]))[2][0]
    assert (after - before) / (2 * h) == pytest.approx(v, abs=1e-8)
    assert (after - 2 * now + before) / h**2 == pytest.approx(a, abs=1e-7)


def test_reference_of_the_joints_is_that_of_the_pose(tilted):
    depth = thesis_experiments(tilted, "computed-torque")[0]
    wanted = depth.reference(tilted, np.array([0.0, 12.5, 17.5]))
    # Reference values: theta3 at d = 200, 250 and 150 mm.
    assert np.degrees(wanted.position[:, 2]) == pytest.approx(
        [21.967097, 39.241659, 3.822554], abs=1e-6
    )
    assert np.all(wanted.velocity[0] == 0)
    assert np.all(wanted.acceleration[0] == 0)


def test_out_of_reach(tilted):
    far = Experiment("d", (0.0, 0.0, 0.3), 0.1, 1.0)
    with pytest.raises(PoseError, match="overstretched"):
        far.reference(tilted, np.linspace(10, 17, 50))
