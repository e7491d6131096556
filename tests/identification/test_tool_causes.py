"""Poses and forces that do not fit together: the cause is named where it is one that is known."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nrs_design.errors import DataError
from nrs_design.identification.datasets import PoseRecord, read_poses
from nrs_design.identification.tables.table import Source
from nrs_design.identification.tool import identify_tool
from tests.identification import synthetic

CENTER = np.array(synthetic.TOOL_CENTER)


def record(seed=1, count=12):
    """Poses with their whole rotations, and some noise."""
    turns = Rotation.random(count, random_state=seed).as_matrix()
    down = -turns[:, 2, :]
    weight = synthetic.TOOL_MASS * 9.81 * down
    noise = np.random.default_rng(seed).normal(scale=2e-3, size=weight.shape)
    force = weight + synthetic.FORCE_BIAS + noise
    torque = np.cross(CENTER, weight) + synthetic.TORQUE_BIAS
    return PoseRecord(Source(Path("poses.csv"), "0" * 64, True), down, force, torque, turns)


def along_the_world(data):
    return replace(data, force=np.einsum("nij,nj->ni", data.turns, data.force))


def turned_back(data):
    turns = data.turns.transpose(0, 2, 1)
    return replace(data, turns=turns, down=-turns[:, 2, :])


def askew(data):
    mounting = Rotation.from_euler("z", 30, degrees=True).as_matrix()
    return replace(data, force=data.force @ mounting.T, torque=data.torque @ mounting.T, turns=None)


def told(data):
    """What is said of the force: a doubt, or the refusal of a mass below zero."""
    try:
        found = identify_tool([data], 9.81)
    except DataError as error:
        return error.message
    return next((text for text in found.doubts if text.startswith("the force misses")), "")


@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize(
    ("change", "said"),
    [
        (along_the_world, "the wrench is given along the axes of the world"),
        (turned_back, "the orientation is that of the world in the sensor"),
        (askew, "the sensor is mounted askew by "),
    ],
)
def test_the_cause_is_named_with_what_it_leaves(change, said, seed):
    text = told(change(record(seed)))
    assert f"likely {said}" in text
    assert float(text.split("would miss ")[1].split(" ")[0]) < 1


def test_what_nothing_known_explains_is_left_open():
    data = record()
    data.force[3:6] += [2.0, -1.0, 0.5]
    doubts = identify_tool([data], 9.81).doubts
    assert any("the tool moved or was touched" in doubt for doubt in doubts)
    assert not any("likely" in doubt for doubt in doubts)


def test_a_good_record_has_no_cause_and_few_poses_name_none():
    assert identify_tool([record()], 9.81).doubts == ()
    few = told(along_the_world(record(count=4)))
    assert few
    assert "likely" not in few


def test_rotations_of_a_file_are_those_of_its_quaternions(tmp_path):
    turns = Rotation.random(6, random_state=4)
    x, y, z, w = turns.as_quat().T
    rows = np.column_stack([w, x, y, z, np.ones((6, 6))])
    path = tmp_path / "poses.csv"
    head = "qw,qx,qy,qz,fx_N,fy_N,fz_N,tx_Nm,ty_Nm,tz_Nm"
    np.savetxt(path, rows, delimiter=",", header=head, comments="")
    read = read_poses(path)
    assert read.turns == pytest.approx(turns.as_matrix())
    assert read.down == pytest.approx(turns.inv().apply([0, 0, -1]))
