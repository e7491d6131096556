"""`verify` on a claim about a range: the box comes from the spec, never from the file."""

import copy
import json
from functools import cache

import pytest

from nrs_design.certificates.certificate import content_id, dump
from nrs_design.certificates.verify import verify_document
from nrs_design.exporters.build import build_record
from nrs_design.pipeline.certification import run_certification
from nrs_design.search.certify import Limits
from nrs_design.spec import read_spec

TEXT = """\
kind: interaction-design
name: ranged
actuator: {gain: 4.8417e-4 rad/s/rpm, time_constant: 0.0351 s}
motion_loop: {damping_ratio: 0.707, settling_time: 0.1404 s, derivative_gain: 2060 rpm*s/rad,
              zero: 56.9706 1/s}
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
environments:
  soft: {model: elastic, stiffness: {nominal: 43 N*m/rad, range: [41 N*m/rad, HIGH N*m/rad]}}
controllers:
  insertion:
    type: impedance
    environment: soft
    Mt: 0.01 kg*m^2
    Bt: {min: 1 N*m*s/rad, max: 4 N*m*s/rad}
switching: arbitrary
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("ranges")


@pytest.fixture(scope="module")
def issue(folder):
    @cache
    def make(high):
        path = folder / f"{high}.nrs.yaml"
        path.write_text(TEXT.replace("HIGH", high))
        spec = read_spec(path)
        result = run_certification(spec, limits=Limits(optimize_rate=False))
        return json.loads(dump(result.certificate)), spec, result

    return make


def fault_of(document, spec):
    signed = {**document, "id": content_id(document)}
    return verify_document(signed, spec).fault


def test_genuine(issue):
    document, spec, _ = issue("45")
    assert document["verdict"] == "proved"
    assert [mode["name"] for mode in document["modes"]] == [
        "insertion/soft/k-min",
        "insertion/soft/k-max",
    ]
    assert fault_of(document, spec) is None


def test_claim_for_a_narrow_range_is_none_for_a_wide_one(issue):
    document, _, _ = issue("45")
    other, wide, _ = issue("400")
    assert other["verdict"] == "refuted"
    # Everything but the numbers is taken from the other certificate.
    forged = {**other, "verdict": "proved", "statements": document["statements"]}
    assert "decrease" in str(fault_of(forged, wide))
    assert fault_of({**document, "spec": other["spec"]}, wide) is not None


@pytest.mark.parametrize(
    ("field", "change"),
    [
        ("assumptions", lambda texts: texts[:-1]),
        (
            "assumptions",
            lambda texts: [t.replace("may change arbitrarily fast", "are constant") for t in texts],
        ),
        ("assumptions", lambda texts: [t for t in texts if "declared ranges" not in t]),
        ("modes", lambda modes: modes[:-1]),
        ("modes", lambda modes: [*modes, {**modes[0], "name": "insertion/soft/k-middle"}]),
    ],
)
def test_what_the_claim_takes_for_granted_cannot_be_changed(issue, field, change):
    document, spec, _ = issue("45")
    changed = copy.deepcopy(document) | {field: change(document[field])}
    assert changed != document
    assert field in str(fault_of(changed, spec))


@pytest.mark.parametrize(
    ("gain", "value", "said"),
    [
        ("Bt", "5", "outside its bounds"),
        ("Mt", "0.01171875", "outside its bounds"),
        # The claim is about the modes of the gains that ship.
        ("Bt", "2.25", "modes"),
    ],
)
def test_gains_are_those_of_the_modes_and_within_their_bounds(issue, gain, value, said):
    document, spec, _ = issue("45")
    changed = copy.deepcopy(document)
    changed["gains"]["insertion"][gain] = value
    assert said in str(fault_of(changed, spec))


def test_what_is_exported_are_the_gains_and_that_there_are_ranges(issue):
    _, _, result = issue("45")
    record = build_record(result.design, result.certificate, result.designed.spec)
    (controller,) = record.controllers
    exported = {gain.name: gain.exact for gain in controller.gains}
    assert exported == result.certificate.gains["insertion"]
    assert any("in the declared ranges" in text for text in record.proof.assumptions)
