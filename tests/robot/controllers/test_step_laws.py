"""Motion control as operations, against the laws and models in doubles that it is recorded from."""

from dataclasses import replace
from fractions import Fraction
from math import degrees

import numpy as np
import pytest

from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.controllers.replica import step
from nrs_design.errors import PoseError
from nrs_design.robot.controllers.motion_laws import JointReference, LawState, LoadModel
from nrs_design.robot.controllers.step_laws import (
    Joints,
    build_base,
    build_computed_torque,
    build_independent_joint,
    build_inverse_dynamics,
)
from nrs_design.robot.controllers.traced_robot import LARGEST_ANGLES
from nrs_design.robot.design.motion_control import (
    design_computed_torque,
    design_independent_joint,
    design_load_model,
)
from nrs_design.robot.models import (
    build_robot,
    direct_kinematics,
    gravity_torque,
    inverse_dynamics,
    inverse_kinematics,
    is_reachable,
    tilt_table,
)
from nrs_design.spec import read_spec
from tests.robot.models.crooked import crooked
from tests.support import ROOT

SPEC = read_spec(ROOT / "specs/robots/neuroboscope.nrs.yaml").spec
THESIS = build_robot(SPEC).tilted(-0.5)
RATIO, PERIOD = 5.0, 0.002
RNG = np.random.default_rng(6)
# Of the encoders, at 8 rad at most: both sides of a difference are rounded.
READING = 1e-6


def poses(robot, count=60):
    found = RNG.uniform((-0.2, -0.3, 0.16), (0.2, 0.3, 0.235), (count, 3))
    return found[is_reachable(robot, found)]


def run(law, **arrays):
    """Compute one step; arrays of shape (n, 3), or (n,), by the beginning of their names."""
    given = {}
    for name, values in arrays.items():
        columns = (
            {name: values}
            if values.ndim == 1
            else {f"{name}_{i + 1}": values[:, i] for i in range(3)}
        )
        given |= {key: np.ascontiguousarray(v, np.float32) for key, v in columns.items()}
    count = len(next(iter(given.values())))
    return step(law, np.zeros(count, np.uint32), given)


def outputs(result):
    return np.stack([v.astype(float) for v in result.outputs.values()], axis=-1)


def base_of(robot, count, correction=(1.0, 1.0, 1.0)):
    gravity = dict(zip(("gravity_x", "_", "gravity_z"), robot.gravity_vector, strict=True))
    ones = np.ones(count)
    return {name: value * ones for name, value in gravity.items() if name != "_"} | {
        "correction": np.array(correction) * ones[:, None]
    }


def exchanged(robot):
    """The side legs in each other's place: their planes cross the other way round."""
    left, right, middle = robot.legs
    sides = replace(left, azimuth=right.azimuth), replace(right, azimuth=left.azimuth)
    return replace(robot, legs=(*sides, middle))


@pytest.mark.parametrize(
    "robot",
    [THESIS, crooked(THESIS), exchanged(THESIS)],
    ids=["thesis", "crooked", "exchanged"],
)
def test_inverse_dynamics_are_those_of_the_model(robot):
    """Coriolis forces and all links; the model itself is checked against Pinocchio elsewhere."""
    check_torques(robot)


def turned(robot, angle):
    """The same robot with all base axes turned about the vertical."""
    legs = tuple(replace(leg, azimuth=leg.azimuth + angle) for leg in robot.legs)
    return replace(robot, legs=legs)


@pytest.mark.parametrize(
    "robot",
    [THESIS, crooked(THESIS), exchanged(THESIS), turned(THESIS, 0.4)],
    ids=["thesis", "crooked", "exchanged", "turned"],
)
def test_the_weight_that_is_fed_forward_is_that_of_the_model(robot):
    """Middle arms with mass beside their plane, and axes in any direction, too."""
    silent = ProportionalDerivative(Fraction(0), Fraction(0))
    law = design_independent_joint(SPEC, LoadModel(robot, RATIO, None))
    law = replace(law, motion=silent, command_per_torque=1.0)
    joints, pose = Joints(robot, RATIO), poses(robot)
    q = inverse_kinematics(robot, pose)
    given = {"angle": RATIO * q, "position": q, "error_before": 0 * q}
    result = run(build_independent_joint(joints, law), **given, **base_of(robot, len(pose)))
    assert result.valid.all()
    wanted = gravity_torque(joints.simplified, pose)
    assert len(pose) > 30
    assert np.abs(wanted).max() > 1
    np.testing.assert_allclose(outputs(result), wanted, atol=5e-6, rtol=2e-6)


def test_the_angles_are_those_of_the_polynomials():
    """Planes to 1.5 rad, the crank to 2 rad: the header says so."""
    assert (Fraction(3, 2), Fraction(3, 2), 2) == LARGEST_ANGLES
    assert [angle.limit for angle in Joints(THESIS, 1.0).angles] == list(LARGEST_ANGLES)


def check_torques(robot):
    """Hold inverse dynamics of a robot against the model, at poses of its workspace."""
    law = build_inverse_dynamics(Joints(robot, RATIO))
    pose = poses(robot)
    joints = inverse_kinematics(robot, pose)
    velocity, acceleration = RNG.normal(0, 1, joints.shape), RNG.normal(0, 5, joints.shape)
    given = base_of(robot, len(joints))
    given.pop("correction")
    result = run(law, angle=RATIO * joints, velocity=velocity, acceleration=acceleration, **given)
    assert result.valid.all()
    wanted = inverse_dynamics(robot, pose, velocity, acceleration)
    assert len(pose) > 30
    assert np.abs(wanted).max() > 3
    np.testing.assert_allclose(outputs(result), wanted, atol=2e-5, rtol=2e-6)


@pytest.mark.parametrize("feeds", [False, True], ids=["pd", "gravity"])
def test_independent_joints_are_those_that_are_simulated(feeds):
    load = design_load_model(SPEC, THESIS) if feeds else None
    simulated = design_independent_joint(SPEC, load)
    law = build_independent_joint(Joints(THESIS, RATIO), simulated)
    joints = inverse_kinematics(THESIS, poses(THESIS))
    angle, before = RATIO * joints, RNG.normal(0, 1e-3, joints.shape)
    position = joints + RNG.normal(0, 1e-3, joints.shape)
    zero = np.zeros_like(joints)
    wanted, state = simulated.step(LawState(before), JointReference(position, zero, zero), angle)
    given = base_of(THESIS, len(joints), load.correction) if feeds else {}
    result = run(law, angle=angle, position=position, error_before=before, **given)
    assert result.valid.all()
    kept = np.stack([v.astype(float) for v in result.states.values()], axis=-1)
    np.testing.assert_allclose(kept, state.error, atol=READING)
    gain = float(simulated.motion.Kp) + float(simulated.motion.Kd) / PERIOD
    np.testing.assert_allclose(outputs(result), wanted, atol=2 * gain * READING)


def test_computed_torque_is_that_which_is_simulated():
    load = design_load_model(SPEC, THESIS)
    simulated = design_computed_torque(SPEC, load)
    law = build_computed_torque(Joints(THESIS, RATIO), simulated)
    joints = inverse_kinematics(THESIS, poses(THESIS))
    angle, before = RATIO * joints, RNG.normal(0, 1e-3, joints.shape)
    position = joints + RNG.normal(0, 1e-3, joints.shape)
    acceleration, zero = RNG.normal(0, 5, joints.shape), np.zeros_like(joints)
    reference = JointReference(position, zero, acceleration)
    wanted, _ = simulated.step(LawState(before), reference, angle)
    result = run(
        law,
        angle=angle,
        position=position,
        acceleration=acceleration,
        error_before=before,
        **base_of(THESIS, len(joints), load.correction),
    )
    assert result.valid.all()
    # The error of readings, in accelerations, times inertia and what a torque is in commands.
    reading = READING * (simulated.Kp + simulated.Kd / PERIOD) / RATIO
    largest = 0.5 * max(load.correction) * simulated.command_per_torque
    np.testing.assert_allclose(outputs(result), wanted, atol=largest * reading, rtol=1e-5)


def test_the_base_gives_gravity_and_the_table():
    """At the tilts of the table, and half between two of them."""
    tilts = np.radians([-75.0, -60.0, -45.0, -30.0, -15.0, 0.0])
    table = tilt_table(THESIS, tilts)
    law = build_base(Joints(THESIS, RATIO), table)
    between = (tilts[1:] + tilts[:-1]) / 2
    for asked, rows in (
        (tilts, table.mean_ratio),
        (between, (table.mean_ratio[1:] + table.mean_ratio[:-1]) / 2),
    ):
        result = run(law, tilt=asked)
        assert result.valid.all()
        found = outputs(result)
        vectors = [THESIS.tilted(tilt).gravity_vector for tilt in asked]
        np.testing.assert_allclose(found[:, 0], [v[0] for v in vectors], atol=3e-6)
        np.testing.assert_allclose(found[:, 1], [v[2] for v in vectors], atol=3e-6)
        np.testing.assert_allclose(found[:, 2:], rows, atol=3e-6)


@pytest.mark.parametrize("tilt", [-75.1, 0.1, 60.0, -114.0, 120.0, np.nan, np.inf])
def test_a_tilt_that_the_table_does_not_have_is_refused(tilt):
    table = tilt_table(THESIS, np.radians([-75.0, -40.0, -5.0]))
    law = build_base(Joints(THESIS, RATIO), replace(table, tilt=np.radians([-75.0, -37.5, 0.0])))
    result = run(law, tilt=np.array([np.radians(tilt)]))
    assert not result.valid[0]
    assert not outputs(result).any()


def test_commands_saturate_where_the_spec_says_it():
    """What is remembered does not."""
    law = build_independent_joint(
        Joints(THESIS, RATIO, Fraction(3000)), design_independent_joint(SPEC, None)
    )
    joints = inverse_kinematics(THESIS, np.tile(THESIS.home, (3, 1)))
    position = joints + np.array([[0.02], [0.0], [-0.02]])
    result = run(law, angle=RATIO * joints, position=position, error_before=np.zeros((3, 3)))
    np.testing.assert_array_equal(outputs(result)[[0, 2]], [[3000.0] * 3, [-3000.0] * 3])
    assert np.abs(outputs(result)[1]).max() < 1
    assert degrees(float(result.states["error_before_1"][0])) == pytest.approx(degrees(0.1), 1e-5)


def test_a_controller_takes_up_any_error():
    """From its start on: a step that is refused would keep its memory, and be refused for good."""
    law = build_independent_joint(Joints(THESIS, RATIO), design_independent_joint(SPEC, None))
    ends = np.array([[1.5, -1.5, 2.0], [-1.5, 1.5, -2.0]])
    before = np.array([[float(state.limit) for state in law.states]] * 2) * -np.sign(ends)
    result = run(law, angle=-RATIO * ends, position=ends, error_before=before)
    assert result.valid.all()
    assert np.abs(outputs(result)).min() > 1e7


def reached(joints):
    """Tell whether the middle leg can be there, and whether all legs can."""
    try:
        pose = direct_kinematics(THESIS, joints)
    except PoseError:
        return False, False
    return True, bool(is_reachable(THESIS, pose))


def test_what_no_pose_has_is_refused():
    """By the weight where the middle leg cannot be there, by the full dynamics where any cannot."""
    joints = RNG.uniform((-1.45, -1.45, -2), (1.45, 1.45, 2), (300, 3))
    wanted = np.array([reached(row) for row in joints])
    simulated = design_independent_joint(SPEC, design_load_model(SPEC, THESIS))
    laws = (
        build_independent_joint(Joints(THESIS, RATIO), simulated),
        build_inverse_dynamics(Joints(THESIS, RATIO)),
    )
    zero = np.zeros_like(joints)
    given = base_of(THESIS, len(joints))
    for law, expected in zip(laws, wanted.T, strict=True):
        vectors = {v.name.removesuffix("_1") for v in law.values if v.name.endswith("_1")}
        arrays = dict.fromkeys(vectors, zero) | given | {"angle": RATIO * joints}
        if "correction" not in vectors:
            del arrays["correction"]
        result = run(law, **arrays)
        assert result.valid.tolist() == expected.tolist()
        assert 0.2 < expected.mean() < 0.98


def test_wrong_inputs_are_refused():
    """An angle beyond the polynomials, and what is no number, wherever it comes in."""
    load = design_load_model(SPEC, THESIS)
    law = build_independent_joint(Joints(THESIS, RATIO), design_independent_joint(SPEC, load))
    home = inverse_kinematics(THESIS, np.tile(THESIS.home, (6, 1)))
    wrong = RATIO * home
    wrong[1, 2] = RATIO * -2.01
    wrong[2, 0] = RATIO * 1.51
    wrong[3, 1] = np.nan
    given = base_of(THESIS, 6, load.correction)
    given["gravity_x"][4] = np.nan
    given["correction"][5, 1] = np.inf
    result = run(law, angle=wrong, position=home, error_before=np.zeros((6, 3)), **given)
    assert result.valid.tolist() == [True, False, False, False, False, False]
    assert not outputs(result)[1:].any()
