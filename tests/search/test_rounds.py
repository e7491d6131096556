"""Search for rounds that grow."""

from dataclasses import replace

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock
from nrs_design.search.certify import certify
from nrs_design.search.period import search_rounds
from tests.proof.systems import bouncing_in_steps, doubled_in_turns, family
from tests.search.support import found, outcome


def test_a_round_that_grows():
    evidence = found(search_rounds, doubled_in_turns(3))
    assert evidence.doublings is not None
    assert [(name, int(count)) for name, count in evidence.steps] == [("m0", 1), ("m1", 2)]
    assert certify(doubled_in_turns(3)).evidence == evidence


def test_two_rounds_that_grow_in_turn():
    """Either alone halves all, and one after the other they grow by two and a quarter."""
    pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
    rest = [[1, 0], [0, 1]]
    system = replace(family(*pair, rest, time=Time.DISCRETE), clock=Clock(3, ("m0", "m1")))
    evidence = found(search_rounds, system)
    assert {name for name, _ in evidence.steps} == {"m0", "m1", "m2"}


def test_what_decays_is_not_refuted():
    assert outcome(search_rounds, doubled_in_turns(4))[0] is None
    assert outcome(search_rounds, bouncing_in_steps())[0] is None
