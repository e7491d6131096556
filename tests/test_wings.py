"""Each wing can be taken away: the core is whole without it, and says what is missing."""

import json
import shutil
from types import SimpleNamespace

import pytest

import nrs_design.wings
from nrs_design.errors import NrsDesignError
from nrs_design.wings import FORMATS, WINGS, load_wing, wing_of
from tests.package import FILES, PACKAGE
from tests.support import ROOT, SOFT_TISSUE, started

CORE = sorted(name for name in FILES if [*name.split("."), ""][1] not in WINGS)
IMPORT_ALL = "import sys, importlib\nfor name in sys.argv[1:]: importlib.import_module(name)"
THESIS_ROBOT = ROOT / "specs" / "robots" / "neuroboscope.nrs.yaml"
ABSENT = "the wing robot is not installed"


@pytest.mark.parametrize(
    ("name", "error", "said"),
    [
        *((f"nrs_design.robot{end}", NrsDesignError, ABSENT) for end in ("", ".pipeline")),
        *((name, ModuleNotFoundError, name) for name in ("scipy", "nrs_design.robot.pipe")),
    ],
)
def test_a_wing_that_is_missing_is_named_and_nothing_else_is_one(monkeypatch, name, error, said):
    def fail(module):
        raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    monkeypatch.setattr(nrs_design.wings, "import_module", fail)
    with pytest.raises(error, match=said):
        load_wing("robot", "pipeline")


def test_whose_a_command_is():
    assert (wing_of("audit"), wing_of("certify-switching")) == ("identification", None)


@pytest.fixture(scope="module", params=WINGS)
def house(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    left_out = shutil.ignore_patterns("__pycache__")
    shutil.copytree(PACKAGE, folder / "nrs_design", ignore=left_out)
    shutil.rmtree(folder / "nrs_design" / request.param)

    def run(*arguments):
        settings = {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
        return started(*arguments, cwd=folder, **settings)

    def program(*arguments):
        # As `-m` does, but it takes the current folder off the path, in which this copy lies.
        return run("-c", "from nrs_design.cli import main; main()", *arguments)

    return SimpleNamespace(wing=request.param, folder=folder, run=run, program=program)


@pytest.mark.slow
def test_the_core_is_whole_without_a_wing(house):
    done = house.run("-c", IMPORT_ALL, *CORE)
    assert (done.returncode, done.stderr) == (0, "")
    where = house.run("-c", "import nrs_design; print(nrs_design.__file__)").stdout
    assert where.startswith(str(house.folder))
    text = " ".join(house.program("--help").stdout.split())
    said = f"(the wing {house.wing} is not installed)"
    assert text.count(said) == len(WINGS[house.wing])
    done = house.program("certify-switching", SOFT_TISSUE)
    assert done.returncode == 0, done.stderr
    assert "PROVED" in done.stdout


@pytest.mark.slow
def test_a_command_of_a_missing_wing_ends_in_one_message(house):
    for command in WINGS[house.wing]:
        for arguments in ((), ("--help",), ("check", THESIS_ROBOT, "-q")):
            done = house.program(command, *arguments)
            assert done.returncode == 2
            assert done.stderr.startswith(
                f"error[NRS000]: the wing {house.wing} is not installed"
            ), done.stderr
            assert "Traceback" not in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("house", FORMATS.values(), indirect=True)
def test_a_format_of_a_missing_wing_ends_in_one_message_and_the_others_stay(house):
    missing = [name for name, wing in FORMATS.items() if wing == house.wing]
    for name in missing:
        done = house.program("export", SOFT_TISSUE, "--format", name, "--out", ".")
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith(f"error[NRS000]: the wing {house.wing} is not installed")
    listed = json.loads(house.program("export", "--list", "--json").stdout)["formats"]
    names = {entry["name"] for entry in listed}
    assert "c" in names
    assert names.isdisjoint(missing)
    done = house.program("export", SOFT_TISSUE, "--format", "json", "--out", ".")
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("house", ["robot"], indirect=True)
def test_a_report_of_a_robot_says_that_its_wing_is_missing(house):
    done = house.program("report", THESIS_ROBOT)
    assert done.returncode == 2, done.stdout
    assert ABSENT in " ".join((done.stdout + done.stderr).split())
