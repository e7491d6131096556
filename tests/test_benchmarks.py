"""The program that runs the benchmarks: whether each one runs is seen at night."""

import json
import sys
from importlib import import_module
from types import SimpleNamespace

import pytest

from benchmarks import __main__ as program
from benchmarks.measure import Comparison, Finding, Size
from tests.support import ROOT

FINDING = Finding("work", "result", "aim", True, 1.0)
COMPARISON = Comparison("work", "peer", 2.0, 1.0, None)
# What only the session of the benchmarks installs.
PEERS = {"sympy", "unicorn"}


@pytest.fixture
def play(monkeypatch):
    """Run the program with two benchmarks of our own, of which the second one fails."""

    def two(size):
        assert size is Size.SMOKE
        return FINDING, COMPARISON

    def breaks(size):
        raise ValueError("a | b\nc")

    def call(*options, last=breaks):
        made = {"benchmarks.first": two, "benchmarks.second": last, "benchmarks.third": two}
        monkeypatch.setattr(program, "BENCHMARKS", ("first", "second", "third"))
        monkeypatch.setattr(program, "import_module", lambda n: SimpleNamespace(run=made[n]))
        monkeypatch.setattr(sys, "argv", ["benchmarks", "--smoke", *options])
        return program.main()

    return call


def test_one_that_fails_is_a_row_and_the_others_are_printed(play, capsys):
    assert play() == 1
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("|")]
    cells = [line.strip("| ").split(" | ") for line in lines if not line.startswith("|---")]
    assert [cell[0] for cell in cells] == [
        *("work", "work", "work", "work"),
        *("benchmark", "second"),
        *("work", "work", "work", "work"),
    ]
    assert cells[5][1] == "FAILED: ValueError: a / b c"
    widths = [line.count("|") for line in lines]
    assert all(widths[i] == widths[i - 1] for i in range(1, len(lines)) if i % 3)
    assert play(last=lambda size: ()) == 0


def test_json_holds_failures_too(play, capsys):
    assert play("--json") == 1
    results = json.loads(capsys.readouterr().out)["results"]
    assert [item["work"] for item in results] == ["work", "work", "second", "work", "work"]
    assert results[2]["error"] == "ValueError: a | b\nc"
    assert results[2]["met"] is False


@pytest.mark.slow
def test_every_benchmark_is_in_the_list_and_can_be_imported():
    files = (ROOT / "benchmarks").glob("*.py")
    running = {path.stem for path in files if "def run(size: Size)" in path.read_text()}
    assert running == set(program.BENCHMARKS)
    for name in program.BENCHMARKS:
        try:
            module = import_module(f"benchmarks.{name}")
        except ModuleNotFoundError as error:
            if error.name not in PEERS:
                raise
        else:
            assert callable(module.run)


def test_the_night_runs_them_all():
    night = (ROOT / "noxfile.py").read_text().split("def nightly(")[1].split("@nox")[0]
    assert '"-m", "benchmarks", "--smoke")' in night
