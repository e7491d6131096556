"""Bounds of a robot in the gate: nothing in the tree is evidence of them but their computation."""

import json
import shutil

import pytest

from nrs_design import __version__
from nrs_design.errors import DesignError
from nrs_design.gating.lock import read_lock, read_lock_if_any
from nrs_design.gating.locked import run_locked
from nrs_design.gating.renew import bounds_of, write_lock
from nrs_design.gating.run import Files, run_gate
from nrs_design.robot.models import Space, bounds_document, compute_bounds
from nrs_design.robot.pipeline import run_robot
from nrs_design.spec.robot_bounds import bounds_file, content_id
from tests.spec.test_robot_bounds import COUPLING, LOADED, write
from tests.support import ROOT

SPACE = Space("0.5", "0.5", ("199.5", "200.5"))


@pytest.fixture
def root(tmp_path, monkeypatch):
    """A spec, the robot that it names, and bounds that nobody has computed."""
    robot = tmp_path / "robots/arm.nrs.yaml"
    robot.parent.mkdir()
    shutil.copy(ROOT / "specs/robots/neuroboscope.nrs.yaml", robot)
    (tmp_path / "axes.nrs.yaml").write_text(f"{LOADED}{COUPLING}contact: kept\n")
    write(robot, {})
    monkeypatch.chdir(tmp_path)
    return tmp_path


def gate(root, *names):
    specs = [root / name for name in names or ("axes.nrs.yaml",)]
    lock = root / "nrs.lock"
    known = bounds_of(read_lock_if_any(lock))
    outcome = run_gate(specs, Files(folder=root / "reports", html=False, bounds=known))
    write_lock(outcome, lock)
    return outcome


def locked(root):
    lock = root / "nrs.lock"
    return run_locked([root / "axes.nrs.yaml"], read_lock(lock), lock)


def of_bounds(outcome):
    (found,) = (item for item in outcome.specs[0].obligations if item.rule.id == "NRS111")
    return found


def answer(monkeypatch, name, told):
    """Let the computation end as told; return how often it was asked for."""
    asked = []

    def check(robot, *_):
        asked.append(robot)
        if isinstance(told, Exception):
            raise told
        return bounds_file(robot), told

    monkeypatch.setattr(name, check)
    return asked


def computed(monkeypatch, told):
    return answer(monkeypatch, "nrs_design.robot.pipeline.check_robot_bounds", told)


def tried(monkeypatch, told):
    return answer(monkeypatch, "nrs_design.robot.pipeline.contradict_robot_bounds", told)


def test_what_was_computed_again_is_met_and_on_trust_when_locked(root, monkeypatch):
    asked = computed(monkeypatch, ())
    found = of_bounds(gate(root))
    assert str(found.status) == "met"
    assert "every bound was computed again" in found.message
    tried(monkeypatch, ())
    outcome = locked(root)
    assert outcome.severity == 0
    (caution,) = (c for c in outcome.specs[0].cautions if "on trust" in c.message)
    assert "robots/arm.bounds.json; the lock file says that a gate" in caution.message
    assert len(asked) == 1


def test_bounds_are_computed_again_when_their_hash_is_new(root, monkeypatch):
    asked = computed(monkeypatch, ())
    tried(monkeypatch, ())
    gate(root)
    outcome = gate(root)
    assert len(asked) == 1
    assert any("on trust" in c.message for c in outcome.specs[0].cautions)
    before = (root / "nrs.lock").read_text()
    gate(root)
    assert (root / "nrs.lock").read_text() == before
    write(root / "robots/arm.nrs.yaml", {"heaviest": "0.3"})
    gate(root)
    assert len(asked) == 2
    text = (root / "nrs.lock").read_text()
    (root / "nrs.lock").write_text(text.replace(__version__, "0.0.1"))
    gate(root)
    assert len(asked) == 3


def test_bounds_that_do_not_hold_fail(root, monkeypatch):
    computed(monkeypatch, ("heaviest: too small",))
    outcome = gate(root)
    assert outcome.severity == 2
    assert str(of_bounds(outcome).status) == "missed"
    assert "claims what does not hold: heaviest: too small" in of_bounds(outcome).message


def test_bounds_that_nobody_decided_fail(root, monkeypatch):
    computed(monkeypatch, DesignError("no bound of inertia was shown"))
    outcome = gate(root)
    assert outcome.severity == 1
    assert str(of_bounds(outcome).status) == "inconclusive"


def test_a_robot_is_examined_once_for_all_specs(root, monkeypatch):
    asked = computed(monkeypatch, ())
    text = (root / "axes.nrs.yaml").read_text()
    name = next(line for line in text.splitlines() if line.startswith("name: "))
    (root / "more.nrs.yaml").write_text(text.replace(name, "name: another"))
    gate(root, "axes.nrs.yaml", "more.nrs.yaml")
    assert len(asked) == 1


def test_a_pose_fails_what_is_locked(root, monkeypatch):
    computed(monkeypatch, ())
    gate(root)
    tried(monkeypatch, ("heaviest: too small",))
    outcome = locked(root)
    assert str(of_bounds(outcome).status) == "missed"


def test_a_lock_that_says_nothing_of_bounds_fails(root, monkeypatch):
    computed(monkeypatch, ())
    gate(root)
    document = json.loads((root / "nrs.lock").read_text())
    document["specs"][0]["goals"] = [
        goal for goal in document["specs"][0]["goals"] if goal["rule"] != "NRS111"
    ]
    (root / "nrs.lock").write_text(json.dumps(document))
    tried(monkeypatch, ())
    outcome = locked(root)
    assert str(of_bounds(outcome).status) == "missed"
    assert "does not say that the bounds were computed again" in of_bounds(outcome).message


@pytest.mark.slow
def test_forged_and_certified_again_does_not_pass(root):
    """Between what poses show and what is proved, only the computation can tell: it does."""
    path = root / "robots/arm.nrs.yaml"
    loaded, _, robot = run_robot(path)
    document = bounds_document(
        loaded.spec.name, loaded.sha256, SPACE, compute_bounds(robot, SPACE), "1"
    )
    file = bounds_file(path)
    file.write_text(json.dumps(document))
    assert str(of_bounds(gate(root)).status) == "met"
    assert str(of_bounds(locked(root)).status) == "met"
    for key, factor in {"heaviest": 0.9, "lightest": 1.1}.items():
        forged = json.loads(json.dumps(document))
        for place in (forged["bounds"], forged["found"][key]):
            name = key if place is forged["bounds"] else "value"
            place[name] = str(round(float(document["bounds"][key]) * factor, 6))
        file.write_text(json.dumps(forged | {"id": content_id(forged)}))
        outcome = gate(root)
        assert str(of_bounds(outcome).status) == "missed"
        assert f"{key}: " in of_bounds(outcome).message
        assert str(of_bounds(locked(root)).status) == "missed"
