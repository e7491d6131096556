"""Rules of switching that name controllers in one contact each: what a proof makes of them."""

import json

import pytest

from tests.simulation.interactions import text_of
from tests.support import run

# The agile controller makes the tool unstable, and is left there in time.
LAW = "{type: impedance, environment: %s, contacts: [tissue, tool], Mt: 0.03 kg*m^2, "
TEXT = text_of(
    {"agile": LAW % "tissue" + "Bt: 1.04 N*m*s/rad}", "careful": LAW % "tool" + "Bt: 4 N*m*s/rad}"},
    {
        "tissue": "{model: elastic, stiffness: 43.0356 N*m/rad}",
        "tool": "{model: elastic, stiffness: 104.7 N*m/rad}",
    },
    more="design: {significant_digits: 3}\ncontact: kept\n",
).replace("arbitrary", "RULES")


@pytest.mark.slow
def test_a_wrong_controller_that_is_unstable_is_proved_for_as_long_as_it_lasts(tmp_path):
    """Under arbitrary switching it may last, and that is refuted."""
    rules = (
        "{dwell_time: {agile/tissue: 0.93 s, careful/tool: 0.93 s}, "
        "longest_dwell_time: {agile/tool: 70 ms, careful/tissue: 70 ms}, "
        "transitions: [[agile/tissue, agile/tool], [agile/tool, careful/tool], "
        "[careful/tool, careful/tissue], [careful/tissue, agile/tissue]]}"
    )
    (tmp_path / "ours.nrs.yaml").write_text(TEXT.replace("RULES", rules))
    run("certify-switching", "ours.nrs.yaml", "--out", "ours.cert.json", cwd=tmp_path, code=0)
    run("verify", "ours.cert.json", "ours.nrs.yaml", cwd=tmp_path, code=0)
    (tmp_path / "any.nrs.yaml").write_text(TEXT.replace("RULES", "arbitrary"))
    refuted = run(
        "certify-switching", "any.nrs.yaml", "--out", "any.cert.json", cwd=tmp_path, code=1
    )
    assert "agile/tool" in refuted.stdout


def test_rules_about_contacts_by_hand_with_ranges(tmp_path):
    """The corners of a range belong to its contact: the rules let them follow each other."""
    text = TEXT.replace("104.7 N*m/rad", "50 N*m/rad")
    text = text.replace("43.0356 N*m/rad", "{nominal: 43 N*m/rad, range: [42 N*m/rad, 44 N*m/rad]}")
    rules = "{transitions: [[agile/tissue, agile/tool], [agile/tool, careful/tool]]}"
    (tmp_path / "given.nrs.yaml").write_text(text.replace("RULES", rules))
    result = run(
        "certify-switching", "given.nrs.yaml", "--out", "ours.cert.json", "--json", cwd=tmp_path
    )
    document = json.loads((tmp_path / "ours.cert.json").read_text())
    assert result.returncode == 0
    allowed = document["switching"]["transitions"]
    assert ["agile/tissue/k-min", "agile/tissue/k-max"] in allowed
    assert ["agile/tissue/k-max", "agile/tool"] in allowed
    assert ["careful/tool", "agile/tool"] not in allowed
