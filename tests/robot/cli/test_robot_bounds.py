"""``nrs-design robot bounds`` and ``verify --bounds`` as typed."""

import json
import shutil

import pytest

from nrs_design.spec.robot_bounds import content_id
from tests.support import ROOT
from tests.support import run as run_in

ROBOT = ROOT / "specs/robots/neuroboscope.nrs.yaml"
SPEC = ROOT / "specs/neuroboscope/soft-tissue-axes.nrs.yaml"
CERTIFICATE = ROOT / "reports/soft-tissue-axes.cert.json"


def run(*words):
    return run_in(*words, cwd=ROOT)


@pytest.mark.parametrize("depth", ["150", "240,150", "a,b", "0,1"])
def test_depths_that_are_none(depth):
    result = run("robot", "bounds", ROBOT, "--depth", depth)
    assert result.returncode == 2
    assert "two depths in mm" in result.stderr


def test_an_angle_that_is_none():
    assert run("robot", "bounds", ROBOT, "--phi", "-3").returncode == 2


def test_the_declared_workspace_is_not_reachable():
    result = run("robot", "bounds", ROBOT)
    assert result.returncode not in (0, 1)
    assert "overstretched" in result.stderr


def test_check_refuses_bounds_of_another_robot(tmp_path):
    robot = tmp_path / ROBOT.name
    robot.write_text(ROBOT.read_text().replace("mass: 797.2 g", "mass: 897.2 g"))
    shutil.copy(ROBOT.with_name("neuroboscope.bounds.json"), tmp_path)
    result = run("robot", "bounds", robot, "--check")
    assert result.returncode == 1
    assert "the robot has changed" in result.stdout


@pytest.fixture(scope="module")
def copied(tmp_path_factory):
    """The specs of the repository, with a certificate that rests on the bounds of the robot."""
    root = tmp_path_factory.mktemp("copied")
    shutil.copytree(ROOT / "specs", root / "specs")
    certify(root)
    return root


def certify(root):
    done = run_in("certify-switching", SPEC.relative_to(ROOT), "--out", "c.json", cwd=root)
    assert done.returncode == 0, done.stderr
    return done.stdout


def verify(root, *words):
    return run_in("verify", "c.json", SPEC.relative_to(ROOT), *words, cwd=root)


def forge(root, edit):
    """Edit the bounds, and sign them anew."""
    file = root / "specs/robots/neuroboscope.bounds.json"
    document = json.loads(file.read_text())
    edit(document)
    file.write_text(json.dumps(document | {"id": content_id(document)}))


def lowered(document):
    document["bounds"]["heaviest"] = "0.0038"


def lowered_with_what_was_found(document):
    lowered(document)
    document["found"]["heaviest"]["value"] = "0.00379"


def test_verify_says_first_what_it_takes_on_trust(copied):
    result = verify(copied)
    assert result.returncode == 0
    first = result.stdout.splitlines()[0]
    assert first.startswith("PROVED, on trust in ")
    assert "neuroboscope.bounds.json" in first
    document = json.loads(verify(copied, "--json").stdout)
    assert document["on_trust"].endswith("neuroboscope.bounds.json")
    assert "which are taken on trust" in document["claims"][0]
    assert any("taken on trust from the file of bounds" in t for t in document["assumptions"])


def test_bounds_that_contradict_what_was_found_are_refused_at_once(copied, tmp_path):
    root = shutil.copytree(copied, tmp_path / "root")
    forge(root, lowered)
    result = verify(root)
    assert result.returncode == 2
    assert "bounded by 0.0038, and 0.279659 was found at a pose" in result.stderr


def test_a_pose_contradicts_what_was_forged_twice(copied, tmp_path):
    """A new certificate for forged bounds holds, but the bounds do not."""
    root = shutil.copytree(copied, tmp_path / "root")
    forge(root, lowered_with_what_was_found)
    assert "computed by" not in certify(root)
    result = verify(root)
    assert result.returncode == 1
    assert result.stdout.startswith("REJECTED: the bounds of the robot do not hold")
    assert "heaviest: inertia 0.279659 kg*m^2 at phi" in result.stdout
    assert "PROVED" not in result.stdout
    assert json.loads(verify(root, "--json").stdout)["verdict"] == "rejected"


def test_bounds_need_a_spec_with_a_robot():
    result = run("verify", CERTIFICATE, "--bounds")
    assert result.returncode == 2
    assert "needs a SPEC that names a robot" in result.stderr
