"""A gate over a file with several axes: each is a spec of its own, and none gets lost."""

import json

import pytest

from nrs_design.spec.templates import TASK_SPACE, TEMPLATES
from tests.support import run

from .conftest import edit

QUICK = ("--no-reports",)


@pytest.fixture
def folder(tmp_path):
    for name in ("base", "here"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "two.nrs.yaml").write_text(TEMPLATES[TASK_SPACE], encoding="utf-8")
    return tmp_path


def test_every_axis_is_locked_and_examined_again(folder):
    here = folder / "here"
    done = run("gate", "two.nrs.yaml", *QUICK, cwd=here, code=0)
    assert "2 specs: 2 proved" in done.stdout
    lock = json.loads((here / "nrs.lock").read_text(encoding="utf-8"))
    assert [spec["path"] for spec in lock["specs"]] == ["two.nrs.yaml#rx", "two.nrs.yaml#z"]
    run("gate", "two.nrs.yaml", "--locked", cwd=here, code=0)
    # One axis more tissue, and one that is gone.
    edit(here / "two.nrs.yaml", "[700 N/m, 780 N/m]", "[600 N/m, 780 N/m]")
    done = run("gate", "two.nrs.yaml", "--locked", cwd=here, code=1)
    assert "two.nrs.yaml#z" in done.stdout
    assert "has changed since it was locked" in done.stdout
    edit(here / "two.nrs.yaml", "  rx:\n", "  ry:\n")
    done = run("gate", "two.nrs.yaml", "--locked", cwd=here, code=1)
    assert "two.nrs.yaml#rx" in done.stdout
    assert "no longer exists" in done.stdout


def test_a_base_is_compared_axis_by_axis(folder):
    base, here = folder / "base", folder / "here"
    run("gate", "two.nrs.yaml", *QUICK, cwd=base, code=0)
    done = run("gate", "two.nrs.yaml", *QUICK, "--against", "../base", cwd=here, code=0)
    assert "0 weaker" in done.stdout
    edit(here / "two.nrs.yaml", "[700 N/m, 780 N/m]", "[710 N/m, 780 N/m]")
    done = run("gate", "two.nrs.yaml", *QUICK, "--against", "../base", cwd=here, code=1)
    (line,) = [text for text in done.stdout.splitlines() if "NRS110" in text and "#" in text]
    assert line.startswith("two.nrs.yaml#z:29:")
    assert "values of before are not covered" in line
    # An axis that is gone asks for nothing any more; the other is compared when named alone.
    edit(here / "two.nrs.yaml", "  rx:\n", "  ry:\n")
    done = run("gate", "two.nrs.yaml", *QUICK, "--against", "../base", cwd=here, code=1)
    assert "two.nrs.yaml#rx: NRS110 missed: this spec of the base is gone" in done.stdout
    done = run("gate", "two.nrs.yaml#z", *QUICK, "--against", "../base", cwd=here, code=1)
    assert "two.nrs.yaml#z:29:" in done.stdout


def test_findings_are_at_lines_of_the_file(folder):
    here = folder / "here"
    edit(here / "two.nrs.yaml", "Bt: 72 N*s/m", "Bt: 0.2 N*s/m")
    done = run("gate", "two.nrs.yaml", *QUICK, "--format", "sarif", cwd=here)
    results = json.loads(done.stdout)["runs"][0]["results"]
    places = [item["locations"][0]["physicalLocation"] for item in results]
    assert places
    assert {place["artifactLocation"]["uri"] for place in places} == {"two.nrs.yaml"}
    done = run("gate", "two.nrs.yaml", *QUICK, "--format", "github", cwd=here)
    assert "file=two.nrs.yaml,line=" in done.stdout


def test_files_of_an_axis_are_not_those_of_another_spec(folder):
    """A file of the name NAME-AXIS would have the same certificate."""
    here = folder / "here"
    run("gate", "two.nrs.yaml", *QUICK, cwd=here, code=0)
    alone = TEMPLATES["interaction-design"]
    (here / "other.nrs.yaml").write_text(
        alone.replace("name: my-robot ", "name: my-robot-z "), encoding="utf-8"
    )
    done = run("gate", "other.nrs.yaml", *QUICK, cwd=here)
    assert done.returncode == 2
    assert "belongs to two.nrs.yaml#z" in done.stdout
    both = run("gate", ".", *QUICK, cwd=here)
    assert "is named 'my-robot-z' too" in both.stdout
