"""Rules of switching that name controllers in one contact each: what a proof makes of them."""

import json

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
