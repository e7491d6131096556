from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.assumption import Assumption
from nrs_design.proof.contact import Flights
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock, Stay, Switching
from tests.proof.systems import bouncing_in_steps, family, matrix, pushed, resets_between

HALF = Fraction(1, 2)


def test_stays_by_mode():
    own = ("m1", Stay(Fraction(3), Fraction(4))), ("m2", Stay(HALF, Fraction(9)))
    rules = Switching(Fraction(1, 3), stays=own)
    modes = [["1/2"]], [["1/2"]], [["1/2"]]
    system = family(*modes, switching=rules)
    common = Stay(Fraction(1, 3))
    assert system.stays() == {"m0": common, **dict(own)}
    assert [rules.stay(name) for name in ("m0", "m1")] == [common, own[0][1]]
    in_steps = family(*modes, time=Time.DISCRETE, switching=rules).stays()
    assert in_steps == {"m0": Stay(Fraction(1)), **dict(own), "m2": Stay(Fraction(1), Fraction(9))}


def test_a_dwell_time_of_all_modes():
    one_and_a_half = Switching(Fraction(3, 2))
    in_steps = family([["1/2"]], time=Time.DISCRETE, switching=one_and_a_half)
    assert in_steps.stays() == {"m0": Stay(Fraction(3, 2))}


def test_modes_that_need_never_be_left():
    rules = Switching(stays=(("m0", Stay(HALF)), ("m1", Stay(HALF, HALF))))
    modes = family([[1]], [[2]], [[3]], switching=rules).lasting_modes()
    assert [mode.name for mode in modes] == ["m0", "m2"]


def test_edges_without_rules_join_all_pairs():
    edges = family([[1]], [[2]], [[3]]).edges()
    names = [(edge.source.name, edge.target.name) for edge in edges]
    assert names == [(f"m{i}", f"m{j}") for i in range(3) for j in range(3) if i != j]
    assert all(edge.map is None for edge in edges)


def test_edges_follow_transitions_and_take_every_reset():
    resets = resets_between(("m0", "m1", [[2]]), ("m1", "m0", [[5]]), ("m0", "m1", [[3]]))
    rules = Switching(transitions=(("m0", "m1"), ("m1", "m2")), resets=resets)
    edges = family([[1]], [[2]], [[3]], switching=rules).edges()
    assert [(edge.source.name, edge.target.name, edge.map) for edge in edges] == [
        ("m0", "m1", matrix([[2]])),
        ("m0", "m1", matrix([[3]])),
        ("m1", "m2", None),
    ]
    assert family([[1]], [[2]], switching=Switching(transitions=())).edges() == []


def test_other_modes_leave_contact_and_channels_behind():
    other = family([[-1]], switching=Switching(HALF))
    rigid = (Assumption("rigid.all"),)
    changed = replace(pushed(bouncing_in_steps()), assumptions=rigid).with_modes(
        other.modes, other.states, other.switching
    )
    assert changed == replace(other, time=Time.DISCRETE, assumptions=rigid)


def test_what_a_statement_must_cover():
    """Contact that is lost, anywhere or on the surface; and free motion that may last."""
    drops = bouncing_in_steps()
    kept, needed = (
        replace(drops, contact=replace(drops.contact, required=r)) for r in (False, True)
    )
    anywhere, in_turns = (
        replace(kept, flights=Flights(("m0",), ())),
        replace(needed, clock=Clock(2, ("m0",))),
    )
    systems = family([[1]]), kept, needed, anywhere, in_turns
    assert [s.is_losable for s in systems] == [False, False, True, True, True]
    assert [len(s.free_motions()) for s in systems] == [0, 0, 1, 0, 0]
    constant = replace(kept, switching=Switching(fixed_ends=(("m0",),)))
    assert [s.has_constants for s in (kept, constant)] == [0, 1]


def test_uniform_is_of_the_order():
    assert family([[1, 0], [0, 1]], [[2, 0], [0, 2]]).is_uniform
    assert not family([[1, 0], [0, 1]], [[2]]).is_uniform
    assert not family([[1]], [[2, 0], [0, 2]]).is_uniform


def test_the_word_for_a_time_is_that_time():
    """A check that took it for neither would let a contraction be larger than one."""
    system = replace(family([[1]], time=Time.DISCRETE), time="discrete")
    assert system.time is Time.DISCRETE
    with pytest.raises(ValueError, match="never"):
        replace(system, time="never")
