"""Specs that are valid and probably not meant."""

from nrs_design.spec import doubt_spec, parse_spec
from tests.spec.samples import FORCE, IMPEDANCE, SWITCHED, spoiled


def doubts(text):
    return list(doubt_spec(parse_spec(text)))


def test_an_environment_that_no_controller_touches():
    for sample in (IMPEDANCE, FORCE):
        (doubt,) = doubts(sample)
        assert doubt.at == ("environments", "hand")
        assert "environment hand is touched by no controller" in str(doubt)


def test_a_contact_is_touched():
    text = spoiled(IMPEDANCE, "environment: soft", "environment: soft\n    contacts: [soft, hand]")
    assert doubts(text) == []


def test_given_matrices_have_no_environments():
    assert doubts(SWITCHED) == []
