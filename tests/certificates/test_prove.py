"""Certificates by themselves: the proof holds for the modes in the file, and for no others.

Without a spec, whoever writes a file may put any system into it. What must never happen is that
something is accepted that is false of the modes that the file shows.
"""

import copy
import json

import pytest

from nrs_design.certificates.certificate import content_id
from nrs_design.certificates.prove import prove
from nrs_design.certificates.verify import verify_document
from tests.certificates.test_verify import (
    ALL,
    at,
    changed,
    is_true,
    leaves,
    mutations,
    resign,
    signed,
)
from tests.tables import rows


def test_a_certificate_is_proved_without_its_spec(pair):
    document, spec = pair
    alone, beside = prove(document), verify_document(document, spec)
    assert alone.fault is None
    assert alone.certificate == beside.certificate
    assert alone.certificate.verdict == document["verdict"]


@pytest.mark.parametrize("pair", ALL, indirect=True)
@pytest.mark.parametrize("field", ["time", "states", "modes", "switching"])
def test_every_re_signed_change_of_the_system_is_rejected_or_true(pair, field):
    document, _ = pair
    for path in leaves(document[field], (field,)):
        for value in mutations(at(document, path)):
            outcome = prove(resign(changed(document, path, value)))
            assert outcome.fault is not None or is_true(outcome), (path, value)


def altered(document, *path_and_value):
    *path, value = path_and_value
    return resign(changed(document, tuple(path), value))


@pytest.mark.parametrize(("path", "value", "reason"), rows(__file__, "test_malformed_systems"))
def test_malformed_systems(path, value, reason):
    document, _ = signed("given")
    fault = prove(altered(document, *path, value)).fault
    assert fault is not None
    assert reason in fault


@pytest.mark.parametrize(("rules", "reason"), rows(__file__, "test_rules_that_make_no_sense"))
def test_rules_that_make_no_sense(rules, reason):
    document, _ = signed("given")
    assert [mode["name"] for mode in document["modes"]] == ["a", "b"]
    fault = prove(altered(document, "switching", rules)).fault
    assert fault is not None
    assert reason in fault


def test_another_stable_system_is_proved_and_is_not_that_of_the_spec():
    """Why the second step is needed: a file may be right about modes that are nobody's."""
    document, spec = signed("given")
    slower = copy.deepcopy(document["modes"])
    for mode in slower:
        mode["numerators"] = [[2 * entry for entry in row] for row in mode["numerators"]]
    forged = resign({**document, "modes": slower})
    assert prove(forged).fault is None
    assert verify_document(forged, spec).fault == "its field 'modes' is not that of the spec"


def test_modes_that_would_take_hours_are_refused():
    document, _ = signed("given")
    n = 200
    rows = [[10**1000 * (i == j) for j in range(n)] for i in range(n)]
    modes = [{"name": "a", "numerators": rows, "denominator": 1}]
    states = [f"x{i}" for i in range(n)]
    fault = prove(resign({**document, "modes": modes, "states": states})).fault
    assert "too large to check" in fault


def test_what_is_written_is_json():
    document, _ = signed("dwell")
    assert json.loads(json.dumps(document)) == document
    assert document["id"] == content_id(document)
    assert document["switching"] == {"dwell_time": document["switching"]["dwell_time"]}


def test_only_a_valid_proof_is_true_in_a_condition(pair):
    """A certificate that refutes is valid, but no reason to switch a robot on."""
    document, _ = pair
    found = prove(document)
    assert found.fault is None
    assert bool(found) == (document["verdict"] == "proved")
    assert not prove(changed(document, ("id",), "another"))
