"""What the trusted walk over the conditions refuses, whatever the evidence says of itself."""

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.channels import Rounding
from nrs_design.proof.contact import Flights
from nrs_design.proof.evidence import KINDS, AbstractEvidence, Shows
from nrs_design.proof.evidence.abstract import GROWN_WITHOUT_ROUNDING, find_indefinite, is_square
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.exact import MAX_WORK
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Clock, Reset, Switching
from tests.proof import systems
from tests.proof.graphs import common_quadratic, shape_of
from tests.tables import by_rows


def twice(system):
    again = tuple(replace(mode, name=f"{mode.name} again") for mode in system.modes)
    return replace(system, modes=(*system.modes, *again))


SYSTEM = systems.family([[-1, 0], [0, -1]], [[-2, 0], [0, -1]])


@dataclass(frozen=True)
class Claimed(AbstractEvidence):
    """Evidence that consists of the forms it is told."""

    kind = "claimed"
    matrices: tuple = ()
    misfit: str | None = None
    shift: int = 0
    shows = Shows.STABILITY
    rate = None

    def proved_rate(self, system):
        return self.rate

    def find_misfit(self, system):
        return self.misfit

    def forms(self, system):
        for form in self.matrices:
            yield "it fails", tuple(tuple(v << self.shift for v in row) for row in form)

    def claim_in_scope(self, system):
        return "It is so."


def saying(**facts):
    """Return evidence that says of itself what it is told."""
    return type("Said", (Claimed,), facts)()


KEPT = " This holds as long as contact is kept, the environment pulling as it pushes."
GROWN = " This growth is that in kept contact, the environment pulling as it pushes."


NOT_ROUNDED = " This holds for the law computed without rounding."
# Of what is shown: what is said where contact is kept, and of a law that rounds; and whether the
# loss of contact must be covered.
TAKEN = (
    (Shows.STABILITY, KEPT, NOT_ROUNDED, True),
    (Shows.BOUND, KEPT, NOT_ROUNDED, True),
    (Shows.INSTABILITY, GROWN, f" {GROWN_WITHOUT_ROUNDING}", False),
    (Shows.NO_COMMON_QUADRATIC, "", "", False),
)


@pytest.mark.parametrize(("what", "kept", "rounded", "is_refused"), TAKEN)
def test_what_is_taken_for_granted_is_said(what, kept, rounded, is_refused):
    one, said = systems.matrix([[1]]), saying(shows=what)
    exact = systems.family([["1/2"]], time=Time.DISCRETE)
    rounding = replace(exact, roundings=(Rounding("x", (one,), (one,)),))
    included = " What single-precision arithmetic rounds in the law is included."
    assert said.claim(rounding) == f"It is so.{rounded}"
    covering = saying(shows=what, covers_rounding=True)
    assert covering.claim(rounding) == f"It is so.{included}"
    for evidence in (said, covering):
        assert evidence.claim(exact) == "It is so."
    assert not said.covers_rounding
    of_all_contact = saying(shows=what, covers_lost_contact=True)
    for system in (systems.bouncing(), systems.bouncing_in_steps()):
        assert said.claim(system) == f"It is so.{kept}"
        assert said.claim(replace(system, contact=None)) == "It is so."
        assert of_all_contact.claim(system) == "It is so."
    system = systems.bouncing()
    losable = replace(system, contact=replace(system.contact, required=True))
    assert said.find_fault(losable) == (
        "evidence of kind claimed does not cover the loss of contact" if is_refused else None
    )
    assert said.find_fault(system) is None
    assert said.find_fault(replace(system, contact=None)) is None
    assert of_all_contact.find_fault(losable) is None


def test_where_the_environment_does_not_act_nothing_pulls():
    """At zero stiffness a mode of contact is one of free motion."""
    system = systems.bouncing()
    (free,) = system.contact.free
    slack = replace(system, modes=(Mode("m0", free.A), *system.modes[1:]))
    constant = replace(slack, switching=Switching(fixed_ends=(("m0", "m1"),)))
    grown, other = (saying(shows=Shows.INSTABILITY, used=frozenset({m})) for m in ("m0", "m1"))
    kept = "It is so. This growth is that in kept contact"
    pulling = ", the environment pulling as it pushes"
    assert grown.claim(slack) == f"{kept}."
    assert other.claim(slack) == f"{kept}{pulling}."
    assert saying().claim(slack).endswith(f"{pulling}.")
    assert not saying().claim(replace(slack, modes=slack.modes[:1])).endswith(f"{pulling}.")
    for share, tail in (("0", "."), ("1/2", f"{pulling}.")):
        value = replace(staying("m0 to m1"), shares=(Fraction(share),))
        assert value.claim(constant).endswith(f"in kept contact{tail}")
    among = replace(
        slack,
        modes=(*slack.modes, Mode("free", free.A)),
        contact=None,
        flights=Flights(("m0", "m1"), ("free",)),
    )
    assert grown.claim(among).endswith("lost and made at any deflection.")
    assert other.claim(among).endswith(f"at any deflection{pulling}.")


def test_a_rate_by_the_step_is_said_in_seconds_too():
    system = replace(systems.bouncing_in_steps(), contact=None)
    words = "A step takes 0.1 s, so that is exp(-alpha t) with alpha"
    assert saying(rate=Fraction(3, 4)).claim(system) == f"It is so. {words} = 2.5 1/s."
    assert saying(rate=Fraction(2, 3)).claim(system) == f"It is so. {words} >= 3.33333 1/s."
    assert saying().claim(system) == "It is so."
    assert saying(rate=Fraction(3, 4)).claim(replace(system, sample_time=None)) == "It is so."


def test_who_does_not_know_of_turns_shows_nothing_where_modes_take_them():
    in_turns = replace(
        systems.family([[Fraction(1, 2)]], [[Fraction(1, 3)]], time=Time.DISCRETE),
        clock=Clock(2, ("m0",)),
    )
    assert Claimed().find_unfit(replace(in_turns, clock=None)) is None
    assert Claimed().find_unfit(in_turns) == (
        "evidence of kind claimed does not know that modes take turns"
    )


def test_unequal_modes_where_they_are_allowed():
    unequal = systems.family([[-1]], [[-1, 0], [0, -1]])
    for system in (unequal, SYSTEM):
        assert saying(allows_unequal_modes=True).find_fault(system) is None


def test_rules_that_contradict_each_other_carry_no_proof():
    odd = replace(SYSTEM, switching=Switching(transitions=(("m0", "m0"),)))
    assert Claimed().find_fault(odd) == "a transition does not lead from one mode to another"


def test_positive_definite_forms_hold():
    assert Claimed((((2, 1), (1, 2)), ((5,),))).find_fault(SYSTEM) is None


@by_rows("form")
def test_one_bad_form_among_good_ones_is_found(form):
    good = ((2, 1), (1, 2))
    assert Claimed((good, form, good)).find_fault(SYSTEM) == "it fails"


def test_a_form_too_large_is_no_proof():
    fault = Claimed((((1,),),), shift=MAX_WORK).find_fault(SYSTEM)
    assert "too large to check" in fault


@pytest.mark.parametrize(
    ("number", "said"),
    [(10**4300, "14285 bits"), (np.int64(3), "int64"), (3.0, "float")],
    ids=["long", "NumPy", "float"],
)
def test_numbers_that_no_file_can_hold_are_no_proof(number, said):
    """Integers of NumPy overflow without a word, long ones cannot be written."""
    assert said in Claimed((((number,),),)).find_fault(SYSTEM)


def test_the_largest_form_is_decided(monkeypatch):
    evidence, n = Claimed((((4, 0), (0, 7)),)), 2
    monkeypatch.setattr("nrs_design.proof.exact.MAX_WORK", n**3 * 3)
    assert evidence.find_fault(SYSTEM) is None
    monkeypatch.setattr("nrs_design.proof.exact.MAX_WORK", n**3 * 3 - 1)
    assert "too large to check" in evidence.find_fault(SYSTEM)


def test_a_misfit_comes_before_the_forms():
    assert Claimed((((0,),),), "of another system").find_fault(SYSTEM) == "of another system"


@pytest.mark.parametrize(
    "A",
    [
        RationalMatrix(((-1, 0), (0, -1)), -1),
        RationalMatrix(((-1, 0), (0, -1)), 0),
        RationalMatrix(((-1, 0),), 1),
        RationalMatrix((), 1),
    ],
)
def test_a_malformed_mode_carries_no_proof(A):
    system = replace(SYSTEM, modes=(*SYSTEM.modes, Mode("odd", A)))
    assert "mode odd is not a square matrix" in Claimed().find_fault(system)


def test_no_modes_or_two_of_one_name_carry_no_proof():
    assert Claimed().find_fault(replace(SYSTEM, modes=())) == "the system has no modes"
    twice = replace(SYSTEM, modes=SYSTEM.modes * 2)
    assert "the same name" in Claimed().find_fault(twice)


def test_resets_and_unequal_modes_must_be_asked_for():
    resets = Switching(resets=(Reset("m0", "m1", systems.matrix([[2, 0], [0, 2]])),))
    assert "does not cover" in Claimed().find_fault(replace(SYSTEM, switching=resets))
    assert "equal size" in Claimed().find_fault(systems.family([[-1]], [[-1, 0], [0, -1]]))


@by_rows("example")
def test_what_is_spread_over_equal_modes_holds_for_all(example):
    system, evidence = systems.genuine(example)
    spread = evidence.spread(system, twice(system))
    assert spread.find_fault(twice(system)) is None
    assert spread.proved_rate(twice(system)) == evidence.proved_rate(system)


@pytest.mark.parametrize("example", systems.SYSTEMS)
def test_the_rate_is_one_of_decay_or_there_is_none(example):
    system, evidence = systems.genuine(example)
    rate = evidence.proved_rate(system)
    assert (rate is None) == (evidence.shows is not Shows.STABILITY)
    assert rate is None or rate > 0


BOUNCING = {
    "conewise-mode-quadratic",
    "conewise-polynomial",
    "conewise-quadratic",
    "periodic-quadratic",
}
CONSTANT = {"constants-quadratic"}
FREE = {"common-quadratic", "common-polynomial"} | CONSTANT | BOUNCING
SETS = {"common-quadratic", "conewise-quadratic", "invariant-ellipsoid"}
SETS |= {"offset-ellipsoid", "periodic-quadratic"}
RULED = {"mode-quadratic", "mode-polynomial"}
GRAPHS = {"common-quadratic", "common-polynomial"} | BOUNCING | RULED
FACTS = {
    # The careful answer is no; these kinds show more.
    "allows_unequal_modes": RULED | {"growing-sequence"},
    "attains_rate": FREE | RULED,
    "bounds_at_once": FREE,
    "covers_clock": GRAPHS - RULED | {"growing-sequence"},
    "covers_lost_contact": BOUNCING
    | {"invariant-ellipsoid", "no-common-quadratic", "saturated-ellipsoid"}
    | {"offset-ellipsoid"},
    "covers_mixtures": SETS
    | BOUNCING
    | {"common-polynomial", "block-triangular", "saturated-ellipsoid"},
    "is_common_quadratic": {"common-quadratic", "conewise-quadratic"},
    # The blocks of the example have polynomials.
    "keeps_bound_in_mixtures": SETS | CONSTANT | {"conewise-mode-quadratic"} | RULED,
    "names_unstable_mode": {"growing-sequence"},
}


@pytest.mark.parametrize("fact", FACTS)
def test_facts_of_the_kinds(fact):
    pairs = [systems.genuine(example) for example in systems.SYSTEMS]
    assert {item.kind for _, item in pairs} == set(KINDS)
    assert {shape_of(item) for _, item in pairs if getattr(item, fact)} == FACTS[fact]


@pytest.mark.parametrize("fact", FACTS)
def test_a_kind_that_says_nothing_of_itself_claims_nothing(fact):
    assert getattr(Claimed(), fact) is False


def test_only_what_speaks_of_saturation_says_how_motions_begin():
    assert Claimed().start_size is Claimed().start_rate(systems.pushed_away()) is None
    pairs = [systems.genuine(example) for example in systems.SYSTEMS]
    sized = {item.kind for _, item in pairs if item.start_size is not None}
    rated = {item.kind for system, item in pairs if item.start_rate(system) is not None}
    assert sized == rated == {"saturated-ellipsoid"}


@pytest.mark.parametrize("example", systems.SYSTEMS)
def test_a_second_opinion_is_given_every_form_that_was_decided(example):
    system, evidence = systems.genuine(example)
    made = []
    assert evidence.find_fault(system, made) is None
    assert made == [form for _, form in evidence.forms(system)]


def test_it_is_given_none_beyond_the_first_that_fails():
    good, bad = ("good", ((1,),)), ("bad", ((-1,),))
    made = []
    assert find_indefinite([good, bad, good], made) == "bad"
    assert made == [((1,),), ((-1,),)]


TINY = Fraction(1, 10**30)


@pytest.mark.parametrize(
    ("rate", "continuous", "discrete"),
    [
        (Fraction(0), False, False),
        (-TINY, False, False),
        (TINY, True, True),
        (1 - TINY, True, True),
        (Fraction(1), True, False),
        (1 + TINY, True, False),
    ],
)
def test_a_rate_of_decay_is_positive_and_in_steps_below_one(rate, continuous, discrete):
    evidence = common_quadratic(((1,),), 0, rate)
    assert (evidence.find_rate_misfit(Time.CONTINUOUS) is None) is continuous
    assert (evidence.find_rate_misfit(Time.DISCRETE) is None) is discrete


@by_rows("M", "square")
def test_as_many_rows_and_columns_as_asked_for(M, square):
    assert is_square(M, 2) is square


def test_evidence_about_every_mode_holds_for_its_equals_too():
    system, evidence = systems.genuine("no-common-quadratic")
    assert evidence.spread(system, twice(system)) is evidence
    system, evidence = systems.genuine("common-quadratic")
    assert evidence.spread(system, twice(system)) == evidence


def test_the_matrix_of_one_quadratic_function():
    """Of a graph with one form in contact, and of an ellipsoid; of nothing else."""
    _, common = systems.genuine("common-quadratic")
    (node,) = common.nodes
    assert common.quadratic == ([list(row) for row in node.form], common.denominator_log2)
    _, region = systems.genuine("saturated-ellipsoid")
    assert region.quadratic == ([list(row) for row in region.Q], region.denominator_log2)
    assert systems.genuine("common-polynomial")[1].quadratic is None
    assert systems.genuine("growing-sequence, average")[1].quadratic is None
