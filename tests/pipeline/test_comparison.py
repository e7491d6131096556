"""Two specs or certificates beside each other."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from nrs_design.certificates.certificate import content_id
from nrs_design.errors import CertificateError, SpecError
from nrs_design.pipeline.comparison import Difference, Part, Side, compare, compare_sides
from tests.support import COMMUTING, ROOT, SOFT_TISSUE

CERTIFICATE = ROOT / "reports" / "commuting.cert.json"
SOFT = ROOT / "reports" / "soft-tissue.cert.json"


def test_a_spec_and_its_certificate_agree():
    found = compare(COMMUTING, CERTIFICATE)
    assert found.differences == ()
    assert set(found.same) == {Part.GAINS, Part.VERDICT, Part.ASSUMPTIONS}
    assert found.not_compared == (Part.SPEC, Part.MARGINS)


@pytest.mark.slow
def test_a_wider_range_changes_margins_and_rate(tmp_path):
    wider = tmp_path / "wider.nrs.yaml"
    wider.write_text(SOFT_TISSUE.read_text().replace(", 768.17 N/m]", ", 868.17 N/m]"))
    found = compare(SOFT_TISSUE, wider)
    where = "environments.soft.stiffness.range[1]"
    assert found.differences[0] == Difference(Part.SPEC, where, "768.17 N/m", "868.17 N/m")
    margins = {d.what: d for d in found.differences if d.part is Part.MARGINS}
    peak = margins["withdrawal: sensitivity peak Ms"]
    assert float(peak.before) < float(peak.after)
    (rate,) = [d for d in found.differences if d.what == "decay rate"]
    assert float(rate.before.split()[0]) > float(rate.after.split()[0]) > 0
    # What is assumed of the tissue names its range.
    ranges = [d.what for d in found.differences if d.part is Part.ASSUMPTIONS]
    assert [what.partition(" (ranges")[0] for what in ranges] == ["tissue.linear"] * 2


def test_a_rejected_certificate_is_never_the_same(tmp_path):
    altered = json.loads(CERTIFICATE.read_text())
    altered["assumptions"] = []
    copy = tmp_path / "copy.cert.json"
    copy.write_text(json.dumps(altered))
    found = compare(CERTIFICATE, copy)
    assert found.compared == (Part.VERDICT,)
    after = {d.what: d.after for d in found.differences}
    assert after["verdict"] == "rejected"
    assert after["fault"]


def test_both_are_read_before_one_is_designed(tmp_path):
    told: list[str] = []
    with pytest.raises(SpecError, match="no such file"):
        compare(SOFT_TISSUE, tmp_path / "gone.nrs.yaml", told.append)
    assert told == []


def test_what_is_no_certificate(tmp_path):
    file = tmp_path / "a.json"
    file.write_text("[")
    with pytest.raises(CertificateError):
        compare(file, CERTIFICATE)


def test_what_only_one_side_has():
    before = Side(Path("a"), "a", {Part.GAINS: {"x": "1", "y": "2"}, Part.MARGINS: {}})
    after = replace(before, parts={Part.GAINS: {"y": "2", "z": "3"}})
    found = compare_sides(before, after)
    assert [(d.what, d.before, d.after) for d in found.differences] == [
        ("x", "1", None),
        ("z", None, "3"),
    ]
    assert Part.MARGINS in found.not_compared
    assert found.same == ()


def test_rates_of_different_things_are_not_set_side_by_side():
    reports = ROOT / "reports"
    found = compare(reports / "soft-tissue.cert.json", reports / "soft-tissue-sampled.cert.json")
    rates = {d.what: (d.before, d.after) for d in found.differences if "per step" in d.what}
    rates |= {d.what: (d.before, d.after) for d in found.differences if d.what == "decay rate"}
    (contraction,) = rates["contraction per step of 0.002 s"][1:]
    assert 0 < float(contraction) < 1
    assert rates["contraction per step of 0.002 s"][0] is None
    assert rates["decay rate"] == ("3.91595 1/s", None)
    assert found.remarks[-1].startswith(
        "The rates are not compared: a decay rate and a contraction"
    )
    alike = compare(reports / "soft-tissue.cert.json", reports / "force-limit.cert.json")
    assert not any("rates" in remark for remark in alike.remarks)


def test_gains_stand_with_their_units():
    found = compare(ROOT / "reports/soft-tissue.cert.json", CERTIFICATE)
    gains = {d.what: d.before for d in found.differences if d.part is Part.GAINS}
    assert gains["motion.Kd"] == "2060 rpm*s/rad"
    assert gains["withdrawal.Bt"].endswith(" N*m*s/rad")


def test_a_range_that_only_a_bound_shows_is_a_difference(tmp_path):
    altered = json.loads(SOFT.read_text())
    (tissue,) = (item for item in altered["assumptions"] if item["id"] == "tissue.linear")
    tissue["fields"][0][1][0] += "0"
    altered["id"] = content_id(altered)
    (tmp_path / "copy.cert.json").write_text(json.dumps(altered))
    found = compare(SOFT, tmp_path / "copy.cert.json")
    assert Part.ASSUMPTIONS not in found.same
    told = [d for d in found.differences if d.part is Part.ASSUMPTIONS]
    assert [d.what.partition(" ")[0] for d in told] == ["tissue.linear"] * 2


@pytest.mark.parametrize("fields", [[], [["unit", []]], [["unit", ["V", "b"]]]])
def test_a_unit_that_is_none_breaks_nothing(tmp_path, fields):
    altered = json.loads(SOFT.read_text())
    altered["assumptions"].append({"id": "command-unit.unit", "fields": fields})
    altered["id"] = content_id(altered)
    (tmp_path / "copy.cert.json").write_text(json.dumps(altered))
    assert Part.ASSUMPTIONS not in compare(SOFT, tmp_path / "copy.cert.json").same
