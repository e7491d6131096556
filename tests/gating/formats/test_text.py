import re
from html import unescape

from nrs_design.gating.formats.text import format_markdown, format_text
from tests.gating.formats.support import GAINS, HOSTILE, obligation, outcome_of


def test_table_and_failures(mixed):
    lines = format_text(mixed).split("\n")
    assert lines[0].split("  ")[0] == "spec"
    (good,) = (line for line in lines if line.startswith("specs/good"))
    assert good.split() == [
        "specs/good.nrs.yaml",
        *["proved", "exists", "alpha", ">=", "1.5", "1/s", "2", "abcdef012345"],
    ]
    assert "specs/a.nrs.yaml:7:3: NRS102 refuted: it grows" in lines
    assert "specs/c.nrs.yaml: NRS900 error: RuntimeError: unforeseen and long" in lines
    assert "1 refuted, 1 proved, 1 without verdict; 7 obligations, 5 not" in format_text(mixed)


def test_gains_are_shown_by_their_shortest_single_precision_decimals():
    units = {"motion": {"Kp": "rpm/rad", "Kd": "rpm*s/rad"}, "tissue": {"Mt": "kg*m^2"}}
    text = format_text(outcome_of(obligation(), gains=GAINS, units=units))
    motion = "motion Kp 117359.44 rpm/rad, Kd 2060 rpm*s/rad"
    assert f"specs/a.nrs.yaml: {motion}; tissue Mt 0.01 kg*m^2\n" in text
    assert "single-precision" in text
    assert "gains" not in format_text(outcome_of(obligation()))


def test_hostile_text_steers_no_terminal():
    text = format_text(outcome_of(obligation(path=f"specs/{HOSTILE}", message=HOSTILE)))
    assert all(line.isprintable() for line in text.split("\n"))
    assert text.count("\n") == format_text(outcome_of(obligation())).count("\n")


def test_the_sum_comes_first_and_every_spec_has_a_row(mixed):
    lines = format_markdown(mixed).splitlines()
    assert unescape(lines[0]).startswith("### ❌ nrs-design: 3 specs: 1 refuted, 1 proved")
    assert unescape(lines[2]).startswith("- specs/c.nrs.yaml: NRS900 error")
    assert sum(line.startswith("| specs/") for line in lines) == 3


def test_what_strangers_wrote_is_no_markup():
    text = format_markdown(
        outcome_of(obligation(path=f"specs/{HOSTILE}", message="<b> @all [x](y)"))
    )
    shown = text.replace("<details><summary>every spec</summary>", "").replace("</details>", "")
    assert not re.search(r"<|@|\]\(", shown)
    assert "<b> @all [x](y)" in unescape(text)
