"""``nrs-design ros2`` as a user types it."""

import json

import pytest

from tests.ros2.support import EXAMPLE, changed
from tests.support import run, typed

SOFT = ("--stiffness", "200..2000 N/m")


def test_proved(tmp_path):
    done = typed(
        "ros2", "check", EXAMPLE, *SOFT, "--age", "0..2", "--lag", "5..20 ms", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    assert "axis x: from 200 to 2000 N/m: stable, in contact, rho <= 0.99" in done.stdout
    assert "PROVED" in done.stdout
    assert "a lag of first order, 5 to 20 ms" in done.stdout


def test_refuted_as_json_and_sarif(tmp_path):
    stiff = ("--stiffness", "90000 N/m", "--age", "2")
    done = run("ros2", "check", EXAMPLE, *stiff, "--json", cwd=tmp_path)
    assert done.returncode == 1
    (found,) = json.loads(done.stdout)["specs"]
    assert found["verdict"] == "refuted"
    done = run("ros2", "check", EXAMPLE, *stiff, "--format", "sarif", cwd=tmp_path)
    results = json.loads(done.stdout)["runs"][0]["results"]
    assert {item["ruleId"] for item in results} == {"NRS202"}
    region = results[0]["locations"][0]["physicalLocation"]["region"]
    assert region["startLine"] == 30


def test_what_surprises_people_is_on_stderr(tmp_path):
    file = changed(tmp_path, ("mass: [5.0, ", "mass: [6.0, "))
    done = run("ros2", "check", file, *SOFT, cwd=tmp_path)
    assert done.returncode == 0
    assert "warning: admittance_controller: admittance.mass: masses differ" in done.stderr


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--stiffness", "200..2000"), "has no unit"),
        (("--stiffness", "200..2000 N*m/rad"), "not a stiffness for translations"),
        (("--stiffness", "2000..200 N/m"), "not a rising range"),
        (("--stiffness", "-5 N/m"), "not a rising range"),
        ((*SOFT, "--age", "2..1"), "does not rise"),
        ((*SOFT, "--age", "one"), "no range of periods"),
        ((*SOFT, "--rate", "0"), "not positive"),
        ((*SOFT, "--rate", "fast"), "fast"),
        ((*SOFT, "--lag", "5"), "has no unit"),
    ],
)
def test_wrong_options(tmp_path, options, message):
    done = run("ros2", "check", EXAMPLE, *options, cwd=tmp_path)
    assert done.returncode == 2
    assert message in done.stderr
    assert done.stdout == ""
