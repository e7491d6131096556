"""Modes that take turns: which are in force when, and which signals keep to that."""

from dataclasses import replace
from fractions import Fraction

from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.proof.clock import keeps_turns, on_turn
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.evidence import FormsOnGraph, GrowingSequence
from nrs_design.proof.evidence.graph import MODES, Node
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from tests.proof import systems
from tests.tables import by_rows

ROUND = Clock(3, ("a", "b"))
# At most one of any three missed: what may follow after none, after one, and after a step more.
ONE_OF_THREE = Clock(3, ("m0",), ((0, 1), (2, -1), (0, -1)))
# Modes a for at least two steps, b for one, and others; what is not a follows no b.
STAYS = Clock(4, ("a",), ((1, -1, -1), (1, 2, -1), (0, 2, 3), (0, -1, 3)), (("b",),))


def signal(text: str) -> list[tuple[str, Fraction]]:
    return [(name, Fraction(count)) for name, count in (item.split(":") for item in text.split())]


@by_rows("clock", "text", "keeps")
def test_signals(clock, text, keeps):
    known = {"round": ROUND, "misses": ONE_OF_THREE, "stays": STAYS}[clock]
    assert keeps_turns(known, signal(text)) is keeps


@settings(deadline=None, max_examples=200)
@given(
    st.lists(st.tuples(st.sampled_from("abxy"), st.integers(1, 4)), min_size=1, max_size=6),
    st.integers(2, 4),
)
def test_against_every_step_written_down(steps, length):
    every = [name in "ab" for name, count in steps for _ in range(count)]
    true = len(every) % length == 0 and any(
        all(first == ((k + start) % length == 0) for k, first in enumerate(every))
        for start in range(length)
    )
    clock = Clock(length, ("a", "b"))
    assert keeps_turns(clock, [(name, Fraction(count)) for name, count in steps]) is true


def test_what_is_in_force_at_a_step():
    system = systems.pushed(systems.bouncing_in_turns(1, rounded=True))
    # What a push makes the arithmetic round, too: its entry must not be taken for a rounding's.
    (item,) = system.roundings
    wide = tuple(systems.matrix([[*row.fractions()[0], 7]]) for row in item.rows)
    system = replace(system, roundings=(replace(item, rows=wide),))
    first, other = (on_turn(system, system.clock, kind) for kind in (0, 1))
    assert [mode.name for mode in first.modes] == ["push 1", "push 2"]
    assert [mode.name for mode in first.contact.free] == ["fall"]
    assert [mode.name for mode in other.modes] == ["rest"]
    assert [mode.name for mode in other.contact.free] == ["fall on"]
    for part, count in ((first, 3), (other, 2)):
        assert part.clock is None
        assert part.outputs == system.outputs
        assert [len(channel.columns) for channel in part.channels] == [count]
        assert {row.shape for row in part.roundings[0].rows} == {(1, 3)}
        assert part.contact.pulls == system.contact.pulls
        assert len(part.roundings[0].columns) == len(part.roundings[0].rows) == count
        assert find_contradiction(part) is None


def test_the_parts_of_a_rounding_are_those_of_their_modes():
    system = systems.bouncing_in_turns(rounded=True)
    (item,) = system.roundings
    marked = tuple(replace(row, numerators=((k, 0),)) for k, row in enumerate(item.rows, start=1))
    system = replace(system, roundings=(replace(item, rows=marked, columns=item.columns),))
    first, other = (on_turn(system, system.clock, kind) for kind in (0, 1))
    assert [row.numerators[0][0] for row in first.roundings[0].rows] == [1, 2, 4]
    assert [row.numerators[0][0] for row in other.roundings[0].rows] == [3, 5]


def test_kept_contact_has_no_free_modes():
    stays = systems.sheared_in_stays(2)
    parts = [on_turn(stays, stays.clock, kind) for kind in stays.clock.kinds]
    assert [[mode.name for mode in part.modes] for part in parts] == [["m0"], ["m1"], ["m2"]]
    system = replace(
        systems.bouncing_in_turns(), contact=None, clock=Clock(2, ("push 1", "push 2"))
    )
    assert on_turn(system, system.clock, 1).contact is None


def test_a_signal_out_of_turn_refutes_nothing():
    """Doubling at every third step grows by 9/8, at every fourth it does not."""
    steps = (("m0", Fraction(1)), ("m1", Fraction(2)))
    growth = GrowingSequence(steps, 6)
    assert growth.find_fault(systems.doubled_in_turns(3)) is None
    assert "not its turn" in growth.find_fault(systems.doubled_in_turns(4))
    assert growth.find_fault(replace(systems.doubled_in_turns(4), clock=None)) is None
    alone = GrowingSequence((("m0", Fraction(3)),), 6)
    assert "not its turn" in alone.find_fault(systems.doubled_in_turns(3))
    late = GrowingSequence((("m0", Fraction(1)), ("m1", Fraction(3))), 6)
    assert "growth" in late.find_fault(systems.doubled_in_turns(4))


def test_what_an_automaton_allows():
    assert not ONE_OF_THREE.is_round
    assert ONE_OF_THREE.after(0, 0) == 0
    assert ONE_OF_THREE.after(0, 1) == 1
    assert ONE_OF_THREE.after(1, 1) is None
    assert [*ONE_OF_THREE.turns()] == [(0, 0, 0), (0, 1, 1), (1, 0, 2), (2, 0, 0)]
    assert [*ROUND.turns()] == [(0, 0, 1), (1, 1, 2), (2, 1, 0)]
    own = [(0, 0, 1), (1, 0, 1), (1, 1, 2), (2, 0, 0), (2, 1, 2), (2, 2, 3), (3, 0, 0), (3, 2, 3)]
    assert [*STAYS.turns()] == own
    assert [one.counts_stays for one in (ONE_OF_THREE, ROUND, STAYS)] == [False, False, True]
    assert STAYS.kind_of(["c", "a", "b", "any other"]) == [2, 0, 1, 2]


def missing(hit: str, miss: str) -> SwitchedSystem:
    return replace(systems.family([[hit]], [[miss]], time=Time.DISCRETE), clock=ONE_OF_THREE)


def forms_of(values: tuple[int, int, int], rate: str) -> FormsOnGraph:
    nodes = (Node(f"{MODES} {k}", ((value,),)) for k, value in enumerate(values))
    return FormsOnGraph(tuple(nodes), 0, Fraction(rate))


def test_a_form_for_each_state_proves_and_less_does_not():
    """Halved in time and times 2.5 when missed: 0.625 in three steps, 0.855 per step by hand."""
    system = missing("1/2", "5/2")
    good = forms_of((100, 12, 36), "9/10")
    assert good.find_fault(system) is None
    assert good.claim(system).startswith("Every solution of x+ = A x, with any mode in force that")
    assert "with the Q of the state of the rule" in good.claim(system)
    faster = forms_of((100, 12, 36), "4/5")
    assert faster.find_fault(system) is not None
    # A miss more often than the rule says is no step of it; one that grows by more is.
    assert good.find_fault(missing("1/2", "3")) is not None
    two = replace(system, clock=Clock(3, ("m0",), ((0, 1), (2, 1), (0, -1))))
    assert good.find_fault(two) is not None
    assert "every place" in good.find_fault(replace(system, clock=None))


def test_growth_along_a_word_that_the_rule_allows():
    word = (("m0", Fraction(2)), ("m1", Fraction(1)))
    assert GrowingSequence(word, 8).find_fault(missing("1/2", "9/2")) is None
    assert "growth" in GrowingSequence(word, 8).find_fault(missing("1/2", "7/2"))
    often = GrowingSequence((("m0", Fraction(1)), ("m1", Fraction(1))), 8)
    assert "not its turn" in often.find_fault(missing("1/2", "7/2"))
    assert "not its turn" in staying("m1").find_fault(missing("1/2", "7/2"))
