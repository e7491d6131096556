"""Attacks on the fields of every kind of evidence.

Whatever is changed, either the evidence is rejected, or what it now says is true all the same.
"""

import json

import pytest

import nrs_design.proof.evidence as evidence_kinds
from nrs_design.proof.evidence import KINDS, read_evidence
from nrs_design.proof.evidence.abstract import AbstractEvidence
from tests.proof.systems import SYSTEMS, genuine
from tests.proof.tamper import mutations
from tests.proof.truth import holds

# What `verify` takes for a rejection.
REJECTIONS = (LookupError, TypeError, ValueError, ArithmeticError, AttributeError)


def read(fields, system) -> AbstractEvidence | None:
    try:
        return read_evidence(fields, system)
    except REJECTIONS:
        return None


def stored(evidence) -> dict:
    return json.loads(json.dumps({"kind": evidence.kind, **evidence.to_fields()}))


def test_every_kind_has_an_example():
    assert {genuine(name)[1].kind for name in SYSTEMS} == set(KINDS)


@pytest.mark.parametrize("kind", ["common-quadratics", "", None, 0])
def test_a_kind_that_does_not_exist_shows_nothing(kind):
    system, evidence = genuine("common-quadratic")
    with pytest.raises(ValueError, match="unknown kind of evidence"):
        read_evidence({**stored(evidence), "kind": kind}, system)


# What is true of missed deadlines is asked of three checkers in tests/certificates/test_mutated.py:
# the oracle knows turns alone.
KNOWN = [name for name in SYSTEMS if name != "periodic-quadratic, missed"]
# Half of all the time would go into the changes to one of them.
EXAMPLES = [
    pytest.param(name, marks=pytest.mark.slow) if name == "mode-polynomial" else name
    for name in KNOWN
]


def test_there_is_nothing_else_than_kinds():
    with pytest.raises(AttributeError, match="no attribute 'Trust'"):
        vars(evidence_kinds)["__getattr__"]("Trust")


@pytest.mark.parametrize("example", KNOWN)
def test_genuine_evidence_is_accepted_and_true(example):
    system, evidence = genuine(example)
    assert evidence.find_fault(system) is None
    assert holds(system, evidence)


@pytest.mark.parametrize("example", SYSTEMS)
def test_evidence_survives_storage(example):
    system, evidence = genuine(example)
    assert read(stored(evidence), system) == evidence


@pytest.mark.parametrize("example", EXAMPLES)
def test_changed_evidence_is_rejected_or_true_all_the_same(example):
    system, evidence = genuine(example)
    rejected = 0
    for words, fields in mutations(stored(evidence)):
        changed = read(fields, system)
        if changed is None or changed.find_fault(system) is not None:
            rejected += 1
            continue
        assert holds(system, changed), words
        # A change that reading forgives must be undone where the certificate is written anew.
        assert changed.claim(system)
    assert rejected > 10


@pytest.mark.parametrize("example", KNOWN)
def test_evidence_of_one_system_is_none_for_another(example):
    fields = stored(genuine(example)[1])
    false = []
    for other in KNOWN:
        system, _ = genuine(other)
        moved = read(fields, system)
        if moved is not None and moved.find_fault(system) is None and not holds(system, moved):
            false.append(other)
    assert not false
