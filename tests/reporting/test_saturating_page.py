"""The page of a spec whose signals saturate: what is said of each of the two loops."""

import re

import pytest

from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_certification
from nrs_design.reporting import build_report
from nrs_design.spec import read_spec
from tests.support import ROOT


@pytest.fixture(scope="module")
def page():
    result = run_certification(read_spec(ROOT / "docs/examples/saturating.nrs.yaml"))
    return build_report(result, run_analysis(result.designed))


def section(page, title):
    return next(part for part in page.sections if part.title == title)


def test_the_lead_says_of_which_loop_each_statement_is(page):
    lead, facts = page.summary[0], dict(page.facts)
    (whole,) = re.findall(r"alpha >?= ([0-9.]+) 1/s", lead)
    assert lead.startswith("Proved: while no signal saturates, decays with alpha")
    start = "from rest with a contact force up to 0.5 N*m"
    assert f"; although signals saturate, decays {start}" in lead
    assert facts["Proved decay rate alpha"].removeprefix(">= ") == f"{whole} 1/s"


def test_no_assumption_contradicts_what_is_proved(page):
    assert "saturation only as stated" in page.summary[1]
    assert "friction or saturation" not in page.summary[1]


def test_every_run_says_whether_signals_are_cut_off_in_it(page):
    plain, *_ = section(page, "Simulated switching").blocks
    assert plain.text.startswith("Nothing is cut off at a limit in this run")
    said, *_ = section(page, "Worst case found").blocks
    assert "Not in it: " in said.text
    assert "the limit of the command" in said.text
