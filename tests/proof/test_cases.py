"""Cases: of several systems one is there for ever, and each has forms of its own."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.certificates.certificate import Certificate, content_id, to_document
from nrs_design.certificates.prove import prove
from nrs_design.proof.contact import Flights
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import Node
from nrs_design.proof.evidence.growing_sequence import GrowingSequence
from nrs_design.proof.evidence.no_common_quadratic import NoCommonQuadratic
from nrs_design.proof.evidence.sentence import free_sentence
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock, Switching
from nrs_design.search.certify import certify
from tests.proof.cases import joined, twice
from tests.proof.systems import (
    bouncing,
    bouncing_in_steps,
    bouncing_in_turns,
    doubled_in_turns,
    family,
    pushed,
)

# Each is stable, as its square is zero; both in turn multiply by four.
UP, DOWN = [[0, 2], [0, 0]], [[0, 0], [2, 0]]
SWITCHED = family(UP, DOWN, time=Time.DISCRETE)
CASES = replace(SWITCHED, cases=(("m0",), ("m1",)))
FORMS = FormsOnGraph(
    (Node("modes 0", ((1, 0), (0, 8))), Node("modes 1", ((8, 0), (0, 1)))), 0, Fraction(3, 4)
)


def test_each_case_has_a_form_of_its_own():
    """There is none for both, and a form of the other case is none of this one."""
    assert (SWITCHED.has_constants, CASES.has_constants) == (False, True)
    assert FORMS.find_fault(CASES) is None
    assert "not a form at every place" in FORMS.find_fault(SWITCHED)
    (up, down) = FORMS.nodes
    for nodes in ((up, up._replace(place=down.place)), (up,), (up, down, down._replace(place="m"))):
        assert replace(FORMS, nodes=nodes).find_fault(CASES) is not None
    assert FORMS.claim(CASES) == (
        "In each of 2 cases, one of which is there for ever, every solution of x+ = A x, switching "
        "arbitrarily among its modes, satisfies |x(t)| <= rho^t |x(0)| with rho = 0.75, where "
        "|x| = sqrt(x' Q x) with the Q of the case."
    )


def test_cases_are_claimed_through_the_loss_of_contact():
    one = bouncing_in_steps()
    every = replace(one, cases=(tuple(mode.name for mode in one.every_mode),))
    said = free_sentence(every, Fraction(1, 2), 1, 1, lost=True, once=True)
    assert "contact lost and made again at any time and switching arbitrarily among its" in said


def test_nothing_grows_across_cases():
    """What is in force for ever is not known, so no growth is shown of it, nor a form excluded."""
    grown = GrowingSequence((("m0", Fraction(1)), ("m1", Fraction(1))), doublings=2)
    assert grown.find_fault(SWITCHED) is None
    none = NoCommonQuadratic((("m0", ((1,), (1,))),))
    for evidence in (grown, none):
        assert "does not know which case is there" in evidence.find_fault(CASES)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"cases": (("m0",),)}, "a mode is in no case, or in two"),
        ({"cases": (("m0", "m1"), ("m1",))}, "a mode is in no case, or in two"),
        ({"switching": Switching(transitions=(("m0", "m1"),))}, "rules of switching"),
        ({"cases": (("m0", "m1"), ())}, "a case has no mode"),
        ({"clock": Clock(2, ("m0",))}, "a turn has no mode"),
        ({"enclosures": (("m0", "m1"),)}, "is in no case"),
    ],
)
def test_what_are_no_cases(change, reason):
    assert reason in find_contradiction(replace(CASES, **change))
    losable = replace(bouncing_in_steps(), cases=(("m0", "free"), ("m1",)))
    assert "a case has no mode, in contact or free" in find_contradiction(losable)
    assert find_contradiction(replace(CASES, enclosures=(("m0",),))) is None
    unlike = replace(family([[-1]], [[-1, 0], [0, -1]]), cases=CASES.cases)
    assert "modes of unlike size" in find_contradiction(unlike)


@pytest.mark.parametrize(
    "part",
    [
        family([[-1, 1], [-1, -2]], time=Time.CONTINUOUS),
        pushed(bouncing_in_steps(1)),
        replace(bouncing(1), flights=None),
        bouncing_in_turns(),
        doubled_in_turns(4),
        replace(SWITCHED, modes=SWITCHED.modes[:1], flights=Flights(("m0",), ())),
    ],
    ids=["flow", "losable", "losable flow", "turns", "turns of one state", "flights"],
)
def test_whatever_a_system_does_it_does_in_each_case(part):
    """A part beside a slower one: the proofs of both are one of the cases."""
    flows = part.time is Time.CONTINUOUS
    found = certify(part).evidence
    assert isinstance(found, FormsOnGraph)
    rate = found.rate / 2 if flows else (1 + found.rate) / 2
    cases = twice(part)
    evidence = joined(cases, (found, replace(found, rate=rate)))
    assert evidence.rate == rate
    assert evidence.find_fault(cases) is None
    document = to_document(Certificate("s", "0" * 64, None, {}, cases, (evidence,), "0"))
    document["id"] = content_id(document)
    assert prove(document).fault is None
