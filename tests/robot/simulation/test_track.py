import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import DesignError
from nrs_design.robot.design.motion_control import ComputedTorque, IndependentJoint
from nrs_design.robot.models.robot import build_robot
from nrs_design.robot.simulation.experiment import Experiment, TrackingRecord
from nrs_design.robot.simulation.track import CONTROLLERS, Encoder, build_tracks, experiment_tilt
from nrs_design.spec import parse_spec
from nrs_design.spec.templates import TEMPLATES

TEXT = TEMPLATES["robot"]
UNBALANCED = TEXT[: TEXT.index("# Thesis 4.4 and its")]


def test_three_controllers_of_the_thesis(spec, tilted):
    torque, joint, balanced = (build_tracks(spec, tilted, name)[0] for name in CONTROLLERS)
    assert isinstance(torque.law, ComputedTorque)
    assert isinstance(joint.law, IndependentJoint)
    assert joint.law.load is not None
    assert isinstance(balanced.law, IndependentJoint)
    assert balanced.law.load is None
    assert torque.mechanism.robot is joint.mechanism.robot
    assert joint.mechanism.balance is None
    assert balanced.mechanism.balance is not None
    # Counter-masses of 2 x 843.6 g and 2 x 1301 g (thesis 4.4, left and right leg).
    mass = [
        sum(b.mass for loads in t.mechanism.robot.loads for b in loads) for t in (joint, balanced)
    ]
    assert mass[1] - mass[0] == pytest.approx(0.8436 + 1.3012 + 0.8441 + 1.3024, abs=1e-3)
    assert {t.encoder.counts for t in (torque, joint, balanced)} == {8192}


def test_tilt_of_the_experiments(spec):
    # Thesis 4.2 and 4.4: -28.5 deg.
    assert experiment_tilt(spec) == pytest.approx(-0.497419, abs=1e-6)
    assert experiment_tilt(parse_spec(UNBALANCED)) == 0


def test_a_robot_without_balance_has_no_balanced_controller():
    spec = parse_spec(UNBALANCED)
    with pytest.raises(DesignError, match="no `balance`"):
        build_tracks(spec, build_robot(spec), "balanced")


ERROR = np.array([[0.01, 0.0, 1e-3], [-0.01, 0.02, -1e-3]])


@pytest.fixture
def record():
    experiment = Experiment("psi", (0.0, 0.0, 0.2), 0.1, np.pi, hold_time=1.0)
    wanted = np.ones((2, 3))
    command = np.array([[1.0, -5.0, 2.0], [3.0, 4.0, 0.0]])
    return TrackingRecord(
        "any", experiment, np.arange(2.0), wanted, wanted - ERROR, wanted - 2 * ERROR, command
    )


def test_root_mean_square_of_each_coordinate(record):
    assert record.rmse == pytest.approx([0.01, 0.02 / 2**0.5, 1e-3])
    assert record.actual_rmse == pytest.approx(2 * record.rmse)


def test_summary_in_the_units_of_the_print(record):
    summary = record.summary()
    assert (summary["controller"], summary["moved"]) == ("any", "psi")
    assert (summary["period"], summary["duration"]) == pytest.approx((2.0, 3.0))
    assert summary["rmse"] == pytest.approx([np.degrees(0.01), np.degrees(0.02 / 2**0.5), 1.0])
    assert summary["actual_rmse"] == pytest.approx([2 * error for error in summary["rmse"]])
    assert summary["largest_command"] == [3, 5, 2]


ENCODER = Encoder(5.0, 8192)
angles = st.lists(st.floats(-2, 2), min_size=3, max_size=3).map(np.array)


@given(joints=angles)
def test_rounds_to_the_nearest_count(joints):
    count = 2 * np.pi / 8192
    read = ENCODER.read(joints)
    assert np.all(np.abs(read - 5 * joints) <= count / 2 * (1 + 1e-9))
    assert read / count == pytest.approx(np.round(read / count), abs=1e-9)
    assert np.array_equal(ENCODER.read(read / 5), read)
