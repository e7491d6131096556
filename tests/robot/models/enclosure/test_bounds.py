"""Bounds over a small workspace: shown, found, written, tampered with."""

import json
from dataclasses import replace
from fractions import Fraction
from itertools import count

import numpy as np
import pytest

from nrs_design.errors import ClockError, DesignError, PoseError
from nrs_design.robot.models import (
    Space,
    bounds_document,
    compute_bounds,
    confirm_bounds,
    coriolis_matrix,
    mass_matrix,
)
from nrs_design.robot.models.enclosure.bounds import goal_of
from nrs_design.robot.models.enclosure.cover import Boxes, cover, cut
from nrs_design.robot.models.enclosure.enclose import enclose, find_largest
from nrs_design.robot.models.enclosure.quantities import QUANTITIES, RobotQuantity
from nrs_design.spec.robot_bounds import content_id
from nrs_design.work import Allowance, Fuse
from tests.support import ROOT

INERTIA = QUANTITIES["heaviest"]
TAMPERED = {"heaviest": 0.9, "velocity_torques": 0.7, "gravity_gradient": 0.9}
SPACE = Space("0.5", "0.5", ("199.5", "200.5"))


@pytest.fixture(scope="module")
def document(robot):
    return bounds_document("arm", 64 * "0", SPACE, compute_bounds(robot, SPACE), "1")


def tampered(document, key, factor):
    altered = json.loads(json.dumps(document))
    altered["bounds"][key] = str(float(Fraction(document["bounds"][key])) * factor)
    return altered | {"id": content_id(altered)}


def poses(count, seed):
    space = SPACE.workspace
    low, high = (-space.phi, -space.psi, space.d[0]), (space.phi, space.psi, space.d[1])
    return np.random.default_rng(seed).uniform(low, high, (count, 3))


@pytest.mark.slow
def test_every_sampled_pose_is_within_the_bounds_and_some_near_them(robot, document):
    bounds = {key: float(value) for key, value in document["bounds"].items()}
    x = poses(2000, 1)
    eigenvalues = np.linalg.eigvalsh(mass_matrix(robot, x))
    assert bounds["lightest"] <= eigenvalues.min()
    assert eigenvalues.max() <= bounds["heaviest"] < 1.03 * eigenvalues.max()
    v = np.random.default_rng(2).normal(size=x.shape)
    v /= np.linalg.norm(v, axis=-1)[:, None]
    torque = np.einsum("nij,nj->ni", coriolis_matrix(robot, x, v), v)
    assert np.linalg.norm(torque, axis=-1).max() <= bounds["velocity_torques"]


@pytest.mark.slow
def test_the_file_holds(robot, document):
    assert list(confirm_bounds(robot, document)) == []


@pytest.mark.slow
def test_a_quantity_that_is_zero_is_bounded(robot):
    """Without gravity no box is below zero, since every operation adds what it may round."""
    weightless = replace(robot, gravity=0.0)
    shown = enclose(weightless, QUANTITIES["gravity_gradient"], SPACE.workspace, goal_of(1.02))
    assert shown.found == 0
    assert shown.cover.reached
    assert shown.bound < 1e-9


@pytest.mark.slow
def test_the_pose_of_the_largest_value_does_not_hang_on_rounding(robot, monkeypatch):
    """Mirrored poses are equal but for rounding."""
    plain = find_largest(robot, INERTIA, SPACE.workspace)
    rng = np.random.default_rng(3)
    at = RobotQuantity.at

    def noisy(self, *args):
        values = at(self, *args)
        return values * (1 + 1e-14 * rng.uniform(-1, 1, values.shape))

    monkeypatch.setattr(RobotQuantity, "at", noisy)
    for _ in range(3):
        assert find_largest(robot, INERTIA, SPACE.workspace) == plain


@pytest.mark.parametrize("phi", ["170", "90", "0", "-0.5"])
def test_angles_whose_sines_do_not_grow_are_refused(robot, phi):
    """The boxes of 170 deg would be those of 10 deg."""
    with pytest.raises(DesignError, match="no bounds of"):
        compute_bounds(robot, replace(SPACE, phi=phi))


@pytest.mark.slow
@pytest.mark.parametrize("light", [1.1, 0.0])
def test_tampered_bounds_are_refuted_with_a_pose(robot, document, light):
    """At once, without halving boxes until the time is over; a lightest of 0 claims nothing."""
    altered = document
    for key, factor in TAMPERED.items():
        altered = tampered(altered, key, factor)
    faults = list(confirm_bounds(robot, tampered(altered, "lightest", light)))
    keys = [key for key in document["bounds"] if light or key != "lightest"]
    assert [fault.partition(":")[0] for fault in faults] == [key.replace("_", " ") for key in keys]
    assert all("at phi" in fault for fault in faults)


def test_the_boxes_are_the_whole_workspace():
    """One box less would be a gap, which the volume shows."""
    low, high = np.array([-1.0, 0.0, 2.0]), np.array([1.0, 1.0, 3.0])

    def bound(boxes):
        return boxes.high.max(axis=0) + boxes.half.max(axis=0), np.argmax(boxes.half, axis=0)

    shown = cover(cut(low, high, (1.0, 0.4, 1.0)), bound, 3.05)
    assert shown.reached
    assert 3 < shown.bound <= 3.05
    volume = np.prod(shown.boxes.high - shown.boxes.low, axis=0)
    assert volume.sum() == pytest.approx(np.prod(high - low), rel=1e-12)
    assert volume[:-1].sum() < np.prod(high - low) * (1 - 1e-6)


def test_a_goal_below_the_truth_is_never_reached():
    whole = Boxes(np.zeros((3, 1)), np.ones((3, 1)))

    def bound(boxes):
        return boxes.high[0], np.zeros(boxes.count, dtype=int)

    rounds = []

    def stop(done, left):
        rounds.append(left)
        if len(rounds) > 6:
            raise TimeoutError

    with pytest.raises(TimeoutError):
        cover(whole, bound, 0.99, progress=stop)


@pytest.mark.parametrize("pace", [0.0, 1e-3, 1.0])
def test_work_ends_a_cover_at_the_same_boxes_whatever_the_clock_says(pace):
    ticks = (pace * tick for tick in count())

    def bound(boxes):
        return boxes.high[0], np.zeros(boxes.count, dtype=int)

    def covered(work):
        fuse = Fuse(1e3, clock=lambda: next(ticks))
        whole = cut(np.zeros(3), np.ones(3), (1.0, 1.0, 1.0))
        return cover(whole, bound, 0.5, Allowance(work, fuse=fuse), lambda boxes: 1.0 + boxes)

    # Two units for the whole, then three for its halves; a third round has but one box.
    assert [covered(work).boxes.count for work in (1.9, 2.0, 4.9, 5.0)] == [1, 2, 2, 3]
    assert not covered(5.0).reached


def test_a_cover_that_the_clock_stops_shows_nothing():
    ticks = count(0, 400)
    whole = cut(np.zeros(3), np.ones(3), (1.0, 1.0, 1.0))
    with pytest.raises(ClockError, match="the clock stopped this"):
        cover(
            whole,
            lambda boxes: (np.full(boxes.count, np.inf), np.zeros(boxes.count, dtype=int)),
            0.5,
            Allowance(fuse=Fuse(1e3, clock=lambda: float(next(ticks)))),
        )


@pytest.mark.slow
def test_work_that_does_not_suffice_shows_nothing(robot):
    shown = enclose(robot, INERTIA, SPACE.workspace, lambda found: found, budget=0.0)
    assert not shown.cover.reached
    assert shown.bound == np.inf
    with pytest.raises(DesignError, match="boxes of poses are left") as caught:
        compute_bounds(robot, SPACE, budget=0.0)
    assert "--budget" in caught.value.remedy


def test_a_workspace_that_cannot_be_reached_is_refused(robot):
    with pytest.raises(PoseError, match="overstretched"):
        compute_bounds(robot, Space.of(robot.workspace))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("said", "key", "shown"),
    [
        ("largest eigenvalue", "heaviest", True),
        ("smallest eigenvalue", "lightest", True),
        # To show these two takes half a minute.
        ("Coriolis", "velocity_torques", False),
        ("gradient", "gravity_gradient", False),
    ],
)
def test_the_table_of_the_page(robot, said, key, shown):
    """``--phi 4 --psi 4 --depth 195,205``: what is found, and a bound as near as is said."""
    lines = (ROOT / "docs/robot/bounds.md").read_text("utf-8").splitlines()
    (row,) = (line for line in lines if line.startswith(f"| {said}"))
    _, bound, found, pose, boxes = (cell.strip() for cell in row.strip("| ").split("|"))
    space = Space("4", "4", ("195", "205"))
    room = 1.35 if key == "velocity_torques" else 1.02
    quantity = QUANTITIES[key]
    if shown:
        whole = enclose(robot, quantity, space.workspace, goal_of(room))
        document = bounds_document("arm", 64 * "0", space, {key: whole}, "1")
        assert bound == document["bounds"][key]
        assert int(boxes) == document["found"][key]["boxes"]
    largest, (phi, psi, d) = find_largest(robot, quantity, space.workspace)
    at = f"{np.degrees(phi):.3g} deg, {np.degrees(psi):.3g} deg, {1e3 * d:.3g} mm"
    worst = 1 / largest if key == "lightest" else largest
    assert (found, pose) == (f"{worst:.6g}", at)
    # The last digit of a bound is rounded to its safe side.
    distance = worst / float(bound) if key == "lightest" else float(bound) / worst
    assert 1 < distance < room * (1 + 1e-4)


@pytest.mark.slow
def test_pinocchio_over_ten_thousand_poses_of_the_workspace(robot):
    """What the file in this repository says, against the dynamics of another library."""
    from benchmarks.pinocchio_tree import Tree
    from nrs_design.spec.robot_bounds import read_bounds

    bounds, document = read_bounds(ROOT / "specs/robots/neuroboscope.bounds.json")
    space = Space(
        document["workspace"]["phi_deg"],
        document["workspace"]["psi_deg"],
        tuple(document["workspace"]["d_mm"]),
    ).workspace
    low, high = (-space.phi, -space.psi, space.d[0]), (space.phi, space.psi, space.d[1])
    rng = np.random.default_rng(11)
    tree, still = Tree(robot), np.zeros(3)
    for x in rng.uniform(low, high, (10_000, 3)):
        weight = tree.torque(x, still, still)
        M = np.array([tree.torque(x, still, unit) - weight for unit in np.eye(3)]).T
        values = np.linalg.eigvalsh((M + M.T) / 2)
        assert bounds.lightest <= values[0]
        assert values[-1] <= bounds.heaviest
        v = rng.normal(size=3)
        v /= np.linalg.norm(v)
        assert np.linalg.norm(tree.torque(x, v, still) - weight) <= bounds.velocity_torques
