"""How far gains may be retuned: the known box, the search for the largest, and bad requests."""

from fractions import Fraction

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.errors import DesignError
from nrs_design.pipeline import run_certification, run_interaction
from nrs_design.pipeline.retuned_gains import bracket_share, run_retuned_gains, with_gain_ranges
from nrs_design.spec import read_spec
from tests.support import ROOT, SOFT_TISSUE

DESIGNED = "{min: 0.1 N*m*s/rad, max: 20 N*m*s/rad}"


def designed(tmp_path, text):
    path = tmp_path / "retuned.nrs.yaml"
    path.write_text(text)
    return run_interaction(read_spec(path), "has nothing to design")


def given(text):
    """The spec with Mt = 0.01, and Bt = 2.3 and 1.4."""
    text = text.replace("{min: 0.01 kg*m^2, max: 1 kg*m^2}", "0.01 kg*m^2")
    return text.replace(DESIGNED, "2.3 N*m*s/rad", 1).replace(DESIGNED, "1.4 N*m*s/rad", 1)


@pytest.mark.parametrize("name", ["soft-tissue", "soft-tissue-sampled"])
def test_nine_per_cent_around_2_3_and_1_4(tmp_path, name):
    """A known box; sampled with delay, motor ranges and losable contact, too."""
    text = (ROOT / f"specs/neuroboscope/{name}.nrs.yaml").read_text()
    loaded = with_gain_ranges(
        designed(tmp_path, given(text)), ["insertion", "withdrawal"], 9, "box"
    )
    assert "Bt: {nominal: 1.4 N*m*s/rad, range: [1.274 N*m*s/rad, 1.526 N*m*s/rad]}" in loaded.text
    assert loaded.spec.name == "box"
    assert run_certification(loaded).certification.verdict is Verdict.PROVED


def test_the_largest_box_is_at_least_the_known_one(tmp_path):
    found = run_retuned_gains(designed(tmp_path, given(SOFT_TISSUE.read_text())))
    assert found.share >= Fraction(9, 100)
    assert found.beyond == found.share * 100 + 1
    assert found.result.certification.verdict is Verdict.PROVED
    low, high = found.ranges["insertion"]
    assert (low + high) / 2 == Fraction("2.3")
    ranged = found.result.loaded.spec.controllers["insertion"].Bt
    assert [end.exact for end in ranged.range] == [low, high]


@pytest.mark.parametrize(
    ("largest", "bracket"),
    [(0, (0, 8)), (7, (0, 8)), (8, (8, 16)), (40, (32, 64)), (99, (64, 128))],
)
def test_the_bracket_holds_the_largest(largest, bracket):
    assert bracket_share(lambda percent: percent <= largest) == bracket


def test_gains_that_have_ranges_are_not_given_others(tmp_path):
    text = (ROOT / "specs/neuroboscope/retuned-gains.nrs.yaml").read_text()
    with pytest.raises(DesignError, match="declares where its gains may be retuned already"):
        run_retuned_gains(designed(tmp_path, text))


def test_without_impedance_controllers_there_is_nothing(tmp_path):
    text = (ROOT / "specs/neuroboscope/force-limit.nrs.yaml").read_text()
    with pytest.raises(DesignError, match="no impedance controller"):
        run_retuned_gains(designed(tmp_path, text))
