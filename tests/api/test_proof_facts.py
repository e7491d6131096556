"""What `--margin` says of delay, period and disturbances, beside the box of ranges."""

import re
from fractions import Fraction

import pytest

from nrs_design.api.proof_facts import loop_facts
from nrs_design.pipeline.margins import ProofMargins
from nrs_design.reporting.remedies import margin_lines
from nrs_design.search.margin import Bracket, CommandMargin, MarginBrackets
from tests.support import SOFT_TISSUE, document_of, run, spec_in

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
THIRD = Fraction(1, 3)
FOUND = MarginBrackets(
    Bracket(Fraction(2), None, "none is refuted: the search ends"),
    Bracket(None, THIRD),
    CommandMargin(Fraction(3, 10), {"command": (THIRD, THIRD, "rad/s")}),
)


def test_doubles_stay_on_the_side_that_is_true():
    summary = loop_facts(FOUND)
    assert summary["delay"] == {
        "proved": 2.0,
        "refuted": None,
        "refuted_in": None,
        "why_not_refuted": "none is refuted: the search ends",
        "unit": "samples",
    }
    assert summary["period"]["proved"] is None
    assert summary["period"]["why_not_refuted"] is None
    assert Fraction(summary["period"]["refuted"]) >= THIRD
    (kept,) = summary["force_limit"]["disturbances"]
    assert Fraction(kept["kept_up_to"]) < THIRD < Fraction(kept["broken_in_simulation_at"])
    assert loop_facts(MarginBrackets(None, None, None)) == {}


def test_what_is_not_found_is_said():
    assert list(margin_lines(ProofMargins())) == []
    delay, period, command = margin_lines(ProofMargins(FOUND))
    assert "proved up to 2 samples, none is refuted: the search ends" in delay
    assert delay.endswith("without disturbances, no bound was looked at")
    assert "none is proved, about 0.333" in period
    assert "rounded down" in command


@pytest.mark.nightly
def test_what_keeps_the_limit_in_json(tmp_path):
    text = f"{TEXT}\ndisturbances: {{command: 8 deg/s}}\n"
    (tmp_path / "commanded.nrs.yaml").write_text(text)
    printed = document_of(
        "certify-switching", "commanded.nrs.yaml", "--margin", cwd=tmp_path, code=0
    )
    force, _ = printed["bounds"]
    (kept,) = printed["loop_margins"]["force_limit"]["disturbances"]
    assert kept["kept_up_to"] == pytest.approx(0.1396263 * 0.3 / force["level"])
    assert kept["broken_in_simulation_at"] > kept["kept_up_to"]
    assert "delay" not in printed["loop_margins"]


@pytest.mark.slow
def test_margins_of_a_sampled_loop(tmp_path):
    """One controller, for speed; delays of one and two samples are proved as well."""
    head, _, _ = TEXT.partition("  withdrawal:")
    path = spec_in(tmp_path, f"{head}switching: arbitrary\nsampling: {{period: 10 ms, delay: 0}}\n")
    result = run(
        *("certify-switching", path.name, "--margin", "--budget", "0.3", "--out", "a.cert.json"),
        cwd=tmp_path,
        code=0,
    )
    told = result.stderr.splitlines()
    written = next(i for i, line in enumerate(told) if "certificate written to" in line)
    assert written < next(i for i, line in enumerate(told) if "delay 1" in line)
    assert re.search(r"force sample: proved up to \d+ samples?, refuted from \d+ s", result.stdout)
    assert re.search(r"period: \S+ s is proved, \S+ s is refuted \(each for", result.stdout)
