"""Arms read from MJCF: the mass matrix and Jacobian of MuJoCo, and nothing that a shape says."""

import numpy as np
import pytest

from nrs_design.errors import SpecError
from nrs_design.robot.models.arm import jacobian_and_mass
from nrs_design.robot.models.urdf import read_arm

mujoco = pytest.importorskip("mujoco")

ARM = """\
<mujoco model="bent">
  <compiler angle="degree" autolimits="true" meshdir="nowhere"/>
  <default><joint armature="0.02" damping="1"/><geom mesh="m"/></default>
  <asset><mesh name="m" file="m.stl"/></asset>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="base" pos="0 0.1 0.3" euler="10 20 30">
      <inertial pos="0 0 0" mass="2" diaginertia="0.1 0.1 0.1"/>
      <body name="upper" pos="0.1 0 0.2" quat="0.9 0.1 -0.3 0.2">
        <inertial pos="0.1 0.02 0" mass="1.5" diaginertia="0.02 0.03 0.04" euler="5 0 40"/>
        <joint name="shoulder" axis="0 1 0.5" pos="0.02 0 -0.03" range="-170 170"/>
        <geom type="mesh" mesh="m"/>
        <body name="fore" pos="0.3 0 0" euler="0 90 0">
          <inertial pos="0 0 0.1" mass="0.8" fullinertia="0.01 0.012 0.008 0.001 0 0.002"/>
          <joint name="slide" type="slide" axis="0.3 0 1" range="-0.2 0.2" armature="0.5"/>
          <body name="hand" pos="0 0.05 0.1">
            <inertial pos="0 0 0" mass="0.3" diaginertia="0.001 0.001 0.001"/>
            <joint name="wrist" axis="1 0 0" pos="0 0.01 0"/>
            <site name="tool" pos="0.02 0.03 0.1" euler="30 0 60"/>
          </body>
        </body>
        <body name="finger" pos="0 0.2 0">
          <inertial pos="0 0 0.02" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/>
          <joint name="grip" axis="0 0 1"/>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="shoulder"/></actuator>
</mujoco>
"""
# As MuJoCo can read it without the mesh.
PLAIN = (
    ARM.replace('<geom type="mesh" mesh="m"/>', "")
    .replace('<asset><mesh name="m" file="m.stl"/></asset>', "")
    .replace('<geom mesh="m"/>', "")
)


@pytest.fixture
def write(tmp_path):
    def written(text):
        path = tmp_path / "arm.xml"
        path.write_text(text, encoding="utf-8")
        return path

    return written


@pytest.mark.parametrize("held", [{}, {"grip": 0.7}, {"slide": 0.1, "grip": -0.3}])
def test_mujoco_has_the_same_arm(write, held):
    arm = read_arm(write(ARM), "tool", held)
    model = mujoco.MjModel.from_xml_string(PLAIN)
    data = mujoco.MjData(model)
    names = [model.joint(i).name for i in range(model.njnt)]
    order = [names.index(joint.name) for joint in arm.joints]
    assert set(names) - {joint.name for joint in arm.joints} == held.keys()
    rng = np.random.default_rng(0)
    for _ in range(5):
        q = rng.uniform(-1, 1, arm.order)
        data.qpos[order] = q
        for name, value in held.items():
            data.qpos[names.index(name)] = value
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        J, M = jacobian_and_mass(arm, q)
        np.testing.assert_allclose(M, full[np.ix_(order, order)], atol=1e-12)
        both = np.zeros((2, 3, model.nv))
        site = model.site("tool").id
        mujoco.mj_jacSite(model, data, both[0], both[1], site)
        R = data.site_xmat[site].reshape(3, 3)
        np.testing.assert_allclose(J[:3], (R.T @ both[0])[:, order], atol=1e-12)
        np.testing.assert_allclose(J[3:], (R.T @ both[1])[:, order], atol=1e-12)


def test_limits_and_armature_are_read(write):
    arm = read_arm(write(ARM), "tool")
    joints = {joint.name: joint for joint in arm.joints}
    assert joints["shoulder"].limits == pytest.approx(np.radians([-170, 170]))
    assert joints["slide"].limits == pytest.approx((-0.2, 0.2))
    assert joints["wrist"].limits is None
    assert [joints[name].armature for name in ("shoulder", "slide")] == [0.02, 0.5]
    assert joints["slide"].slides


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('<joint name="wrist" axis="1 0 0" pos="0 0.01 0"/>', "<freejoint/>", "a body that floats"),
        ('name="wrist" axis', 'name="wrist" type="ball" axis', "neither slides nor turns"),
        ('name="wrist" axis', 'name="wrist" ref="10" axis', "has a `ref`"),
        ("</worldbody>", "</worldbody><equality/>", "tied to each other"),
        ("<worldbody>", '<include file="other.xml"/><worldbody>', "includes others"),
        ('<inertial pos="0 0 0" mass="0.3" diaginertia="0.001 0.001 0.001"/>',
         '<geom type="sphere" size="0.1"/>', "no inertial"),
        ('name="tool"', 'name="other"', "there is no link 'tool'"),
        ('mass="0.8"', 'mass="heavy"', "MuJoCo cannot read it"),
        ('<joint name="wrist"', '<joint name="twist" axis="0 0 1"/><joint name="wrist"',
         "has several joints"),
    ],
)  # fmt: skip
def test_what_is_not_modelled_is_refused(write, old, new, said):
    assert old in ARM
    with pytest.raises(SpecError, match=said) as caught:
        read_arm(write(ARM.replace(old, new, 1)), "tool")
    assert caught.value.remedy
