"""Arms read from URDF: the same as Pinocchio and MuJoCo read, and nothing believed silently."""

import numpy as np
import pytest

from nrs_design.errors import SpecError
from nrs_design.robot.models.arm import jacobian_and_mass
from nrs_design.robot.models.urdf import read_arm
from tests.robot.models.arms import EXAMPLE, random_tree


def joint_order(names, arm):
    return [names.index(joint.name) for joint in arm.joints]


@pytest.mark.parametrize("seed", range(6))
def test_pinocchio_has_the_same_arm(tmp_path, seed):
    pin = pytest.importorskip("pinocchio")
    path = tmp_path / "tree.urdf"
    path.write_text(random_tree(seed), encoding="utf-8")
    arm = read_arm(path, "tool")
    model = pin.buildModelFromXML(path.read_text(encoding="utf-8"))
    data, frame = model.createData(), model.getFrameId("tool")
    order = joint_order(list(model.names)[1:], arm)
    rng = np.random.default_rng(seed)
    for _ in range(5):
        q = rng.uniform(-2, 2, arm.order)
        theirs = np.zeros(arm.order)
        theirs[order] = q
        J, M = jacobian_and_mass(arm, q)
        mass = np.triu(pin.crba(model, data, theirs))
        mass = mass + np.triu(mass, 1).T
        jacobian = pin.computeFrameJacobian(model, data, theirs, frame, pin.LOCAL)
        np.testing.assert_allclose(M, mass[np.ix_(order, order)], rtol=1e-11, atol=1e-11)
        np.testing.assert_allclose(J, jacobian[:, order], rtol=1e-11, atol=1e-11)


@pytest.mark.parametrize("seed", range(3))
def test_mujoco_has_the_same_mass_matrix(tmp_path, seed):
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "tree.urdf"
    path.write_text(random_tree(seed), encoding="utf-8")
    arm = read_arm(path, "tool")
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    names = [model.joint(i).name for i in range(model.njnt)]
    order = joint_order(names, arm)
    rng = np.random.default_rng(seed)
    for _ in range(5):
        q = rng.uniform(-2, 2, arm.order)
        data.qpos[order] = q
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        _, M = jacobian_and_mass(arm, q)
        np.testing.assert_allclose(M, full[np.ix_(order, order)], rtol=1e-9, atol=1e-9)


def test_a_joint_that_is_held_is_a_part_of_the_body(tmp_path):
    """With one joint at a value, the others move as they do with it there."""
    path = tmp_path / "tree.urdf"
    path.write_text(random_tree(1), encoding="utf-8")
    whole, held = read_arm(path, "tool"), read_arm(path, "tool", {"q3": 0.4})
    names = [joint.name for joint in whole.joints]
    keep = [i for i, name in enumerate(names) if name != "q3"]
    assert [joint.name for joint in held.joints] == [names[i] for i in keep]
    q = np.linspace(-1, 1, whole.order)
    q[names.index("q3")] = 0.4
    J, M = jacobian_and_mass(whole, q)
    own, mass = jacobian_and_mass(held, q[keep])
    np.testing.assert_allclose(own, J[:, keep], atol=1e-12)
    np.testing.assert_allclose(mass, M[np.ix_(keep, keep)], atol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('<mass value="5.4"/>', "", "without mass or inertia"),
        ('<mass value="5.4"/>', '<mass value="-5.4"/>', "no rigid body"),
        ('ixx="0.016" iyy="0.082"', 'ixx="0.016" iyy="0.2"', "no rigid body"),
        ('<link name="fore">', '<link name="four">', "a link 'fore' that there is not"),
        ('type="revolute"><parent link="base"/>', 'type="ball"><parent link="base"/>', "'ball'"),
        ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "axis of joint 'q1' is zero"),
        ('<origin xyz="0 0 0.1"/>', '<origin xyz="0 0 ${h}"/>', "is not a number"),
        ('<origin xyz="0 0 0.1"/>', '<origin xyz="0 0.1"/>', "is not three numbers"),
        ('<limit lower="-2" upper="2" velocity="3" effort="20"/>', "", "'q5' has no limit"),
        ("<robot name", "<mujoco name", "no XML"),
        ('<?xml version="1.0"?>', "<!DOCTYPE robot>", "no document type"),
        (
            '<link name="tip"/>',
            '<link name="tip"/><link name="loose"/>',
            "2 links without a",
        ),
    ],
)
def test_what_is_wrong_is_refused(tmp_path, old, new, said):
    text = EXAMPLE.read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "arm.urdf"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(SpecError, match=said) as caught:
        read_arm(path, "tip")
    assert caught.value.path == path


def test_a_joint_without_inertia_is_refused(tmp_path):
    text = EXAMPLE.read_text(encoding="utf-8")
    start = text.index("<inertial>", text.index('<link name="wrist2">'))
    end = text.index("</inertial>", start) + len("</inertial>")
    path = tmp_path / "arm.urdf"
    path.write_text(text[:start] + text[end:], encoding="utf-8")
    with pytest.raises(SpecError, match="'q5' moves a link without inertia"):
        read_arm(path, "tip")


def test_names_are_checked():
    with pytest.raises(SpecError, match="there is no link 'tool'"):
        read_arm(EXAMPLE, "tool")
    with pytest.raises(SpecError, match="there is no joint 'q7'"):
        read_arm(EXAMPLE, "tip", {"q7": 0.0})
    with pytest.raises(SpecError, match="no joint moves the tip"):
        read_arm(EXAMPLE, "base")
