"""What to do next, where nothing was proved."""

from pathlib import Path

import pytest

from nrs_design.pipeline.runs import run_certification
from nrs_design.reporting.remedies import next_steps
from nrs_design.search.certification import Limits
from nrs_design.spec import read_spec
from tests.reporting.conftest import KINDS
from tests.support import COMMUTING, PRINT_ERROR, ROOT, run, spec_in


def steps_of(tmp_path, case):
    path = spec_in(tmp_path, f"kind: switched-system\nname: {case}\n{KINDS[case]}", f"{case}")
    return next_steps(run_certification(read_spec(path), limits=Limits(max_degree=4)))


def test_a_proof_needs_none():
    assert next_steps(run_certification(read_spec(COMMUTING))) == ()


def test_no_rule_helps_a_mode_that_is_unstable_by_itself():
    first, last = next_steps(run_certification(read_spec(PRINT_ERROR)))
    assert first.startswith("A mode is not stable by itself, so no rule of switching helps")
    assert last.startswith("Do not ship")


@pytest.mark.parametrize("case", ["dwell-refuted", "inconclusive", "word"])
def test_a_dwell_time_is_searched_where_it_may_help(tmp_path, case):
    said = " ".join(steps_of(tmp_path, case))
    assert ("--shortest-dwell" in said) == (case != "word")
    assert ("--budget" in said) == (case == "inconclusive")
    assert "--margin" not in said


def test_what_was_just_searched_is_not_advised(tmp_path):
    path = spec_in(tmp_path, f"kind: switched-system\nname: a\n{KINDS['dwell-refuted']}", "a")
    wide = ROOT / "docs/examples/wide-range.nrs.yaml"
    for spec, asked in ((path, "shortest_dwell"), (wide, "margin")):
        result, option = run_certification(read_spec(spec)), f"--{asked.replace('_', '-')}"
        assert option in " ".join(next_steps(result))
        assert option not in " ".join(next_steps(result, **{asked: True}))


@pytest.mark.parametrize(("command", "count"), [("certify-switching", 1), ("report", 2)])
def test_commands_end_with_them(tmp_path, command, count):
    done = run(command, PRINT_ERROR, cwd=tmp_path, code=1)
    said = [line for line in done.stdout.splitlines() if line.startswith("next: ")]
    assert len(said) == count
    assert done.stdout.splitlines()[-count:] == said


def test_commands_can_be_typed_as_they_stand(tmp_path):
    wide = run_certification(read_spec(ROOT / "docs/examples/wide-range.nrs.yaml"))
    steps = next_steps(wide, spec=Path("my specs/a.nrs.yaml"))
    assert steps[0].endswith("certify-switching 'my specs/a.nrs.yaml' --margin")
    assert next_steps(wide)[0].endswith("certify-switching wide-range.nrs.yaml --margin")


@pytest.mark.parametrize(
    ("spec", "command"), [("insertion-axis", "optimize"), ("torque-arm", "tune")]
)
def test_the_command_that_knows_the_gains_follows_from_the_laws(spec, command):
    loaded = read_spec(ROOT / f"docs/examples/{spec}.nrs.yaml")
    steps = next_steps(run_certification(loaded, limits=Limits(budget=0)))
    assert f"See which gains the goals allow: nrs-design {command} {spec}.nrs.yaml" in steps
