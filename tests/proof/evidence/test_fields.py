"""Numbers in certificate files: nothing but exact integers and ratios gets in."""

import json
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.assumption import Assumption
from nrs_design.proof.channels import Rounding
from nrs_design.proof.evidence import BlockTriangular
from nrs_design.proof.evidence import fields as module
from nrs_design.proof.exact import MAX_WORK
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Clock, FixedParameter, Reset, Stay, Switching
from tests.proof import systems
from tests.proof.graphs import common_quadratic
from tests.support import number_in
from tests.tables import by_rows


@pytest.mark.parametrize("value", [True, 1.0, "1", None, [1], Decimal(1), Fraction(1)])
def test_only_an_integer_is_an_integer(value):
    with pytest.raises(TypeError, match="expected an integer"):
        module.read_integer(value)
    with pytest.raises(TypeError, match="expected an integer"):
        module.read_integers([[1, 0], [0, value]])


def test_a_matrix_beyond_all_bounds_is_refused():
    with pytest.raises(ValueError, match="too large to check"):
        module.read_integers([[1 << MAX_WORK]])


def test_only_a_text_is_a_text():
    assert module.read_text("m0") == "m0"
    with pytest.raises(TypeError, match="expected a text"):
        module.read_text(b"m0")


@given(st.fractions(min_value=0))
def test_ratio_survives_the_file(ratio):
    assert module.read_ratio(str(ratio)) == ratio


@pytest.mark.parametrize(
    "text", ["-1/2", "0.5", "1e3", "inf", "nan", "1/-2", " 1", "1/2/3", "1_0", "", "\u0661"]
)
def test_anything_else_is_no_ratio(text):
    with pytest.raises(ValueError, match="not a ratio"):
        module.read_ratio(text)


def test_a_ratio_over_zero_is_no_number():
    with pytest.raises(ZeroDivisionError):
        module.read_ratio("1/0")


@pytest.mark.parametrize(
    ("rate", "continuous", "discrete"),
    [
        (Fraction(1, 2), "alpha = 0.5 1/s", "rho = 0.5"),
        (Fraction("42.60546875"), "alpha = 42.60546875 1/s", "rho = 42.60546875"),
        (Fraction(2, 3), "alpha >= 0.666666 1/s", "rho <= 0.666667"),
        (1 - Fraction(1, 3 * 10**21), "alpha >= 0.999999 1/s", "rho <= 1 - 3.33333e-22"),
    ],
)
def test_words_of_a_rate_say_whether_it_is_rounded(rate, continuous, discrete):
    assert module.rate_words(rate, Time.CONTINUOUS) == continuous
    assert module.rate_words(rate, Time.DISCRETE) == discrete


# What `find_unreadable` lets pass at the most, in bits and in entries.
INTEGER, RATIO, ENTRIES = 14_000, 6_640, 100_000
LONG, MANY_DIGITS = Fraction(1, 10**2000), 10**4300


def half(Q):
    return common_quadratic(((Q,),), 0, Fraction(1, 2))


@pytest.mark.parametrize(
    ("value", "said"),
    [
        *((value, None) for value in (2**INTEGER - 1, 1 - 2**INTEGER, [1, [2]])),
        *((value, f"{INTEGER + 1} bits") for value in (2**INTEGER, -(2**INTEGER))),
        *((Fraction(*n), None) for n in ((2**RATIO - 1, 1), (1, 2**RATIO - 1))),
        *((Fraction(*n), "more than 6640") for n in ((2**RATIO, 1), (1, 2**RATIO))),
        ((None,) * ENTRIES, None),
        ((None,) * (ENTRIES + 1), "100001 entries"),
        (((1, 2), (3, -MANY_DIGITS)), "14285 bits"),
        ((("m0", LONG),), "more than 6640"),
        (((1, np.int64(2)),), "type int64"),
        ([1, [2.0]], "type float"),
        (True, "type bool"),
        (half(np.int8(1)), "type int8"),
        (BlockTriangular(((0,),), ((0, replace(half(1.0), rate=LONG)),)), "type float"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_numbers_that_a_file_can_hold(value, said):
    found = module.find_unreadable(value)
    assert found is None if said is None else said in found


RESET = Reset("m0", "m1", RationalMatrix(((1, -2), (0, 3)), 4))
RULES = Switching(
    dwell_time=Fraction(1, 3),
    transitions=(("m0", "m1"), ("m1", "m0")),
    resets=(RESET, RESET),
    fixed_ends=(("m0", "m1"),),
    fixed_parameters=(FixedParameter("k", Fraction(-3, 8), Fraction(5)),),
    stays=(("m0", Stay(Fraction(1, 2))), ("m1", Stay(Fraction(1), Fraction(7, 2)))),
)
RULED = systems.family([[-1, 0], [0, -1]], [["-1/2", 1], [0, -2]], switching=RULES)


ROUNDED = replace(
    systems.bouncing_in_steps(),
    roundings=(
        Rounding("F", (systems.matrix([[1], ["1/2"]]),) * 3, (systems.matrix([["1/9", 0]]),) * 3),
    ),
)


def stored(system):
    return json.loads(json.dumps(module.system_fields(system)))


AMONG = systems.juggling_among_modes()
PULLING = replace(AMONG, flights=replace(AMONG.flights, pulls=(systems.matrix([[1, 0, 2]]),)))
WRITTEN = {
    **systems.SYSTEMS,
    "ruled": lambda: RULED,
    "rounded": lambda: ROUNDED,
    "pulling in flight": lambda: PULLING,
    "the shortest round": lambda: systems.doubled_in_turns(2),
    "the longest round": lambda: systems.doubled_in_turns(100),
    "the longest rule for misses": lambda: replace(
        systems.doubled_in_turns(2), clock=Clock(1000, ("m0",), ((0, 1),) * 1000)
    ),
}


@pytest.mark.parametrize("example", WRITTEN)
def test_what_is_written_is_read(example):
    system = WRITTEN[example]()
    assert module.read_system(system.name, stored(system)) == system


def test_without_rules_there_is_a_word():
    assert stored(systems.genuine("common-quadratic")[0])["switching"] == "arbitrary"


@pytest.mark.parametrize("value", [2**14_000, -(2**14_000)])
def test_numbers_that_python_would_not_read_back_are_not_written(value):
    system = replace(RULED, modes=(Mode("m0", RationalMatrix(((value,),))),))
    with pytest.raises(ValueError, match="more digits"):
        module.system_fields(system)
    with pytest.raises(ValueError, match="more digits"):
        module.system_fields(
            replace(system, modes=(Mode("m0", RationalMatrix(((1,),), abs(value))),))
        )


def test_the_longest_numbers_that_python_reads_back_are_written():
    longest = 2**14_000 - 1
    system = replace(RULED, modes=(Mode("m0", RationalMatrix(((longest, -1),), longest)),))
    assert module.system_fields(system)["modes"][0]["denominator"] == longest


@by_rows("field", "value", "reason")
def test_malformed_systems(field, value, reason):
    fields = stored(RULED)
    if isinstance(value, dict) and field == "switching":
        value = fields["switching"] | value
    with pytest.raises((KeyError, ValueError, TypeError), match=reason):
        module.read_system("x", {**fields, field: value})


def test_a_field_that_is_missing_is_named():
    fields = stored(RULED)
    del fields["states"]
    with pytest.raises(KeyError, match="states"):
        module.read_system("x", fields)


def tens(count):
    """Modes of ten states, each of which takes a hundredth of the work that is allowed."""
    rows = [[2 ** (10**5 - 1) * (i + j == 0) for j in range(10)] for i in range(10)]
    return [{"name": f"m{k}", "numerators": rows, "denominator": 1} for k in range(count)]


def test_the_largest_family_that_is_read():
    states, tiny = [f"x{i}" for i in range(10)], {"numerators": [[1]], "denominator": 1}
    fields = stored(systems.family([[1]])) | {"states": states, "modes": tens(100)}
    assert len(module.read_system("x", fields).modes) == 100
    fields["modes"].append({"name": "one more", **tiny})
    with pytest.raises(ValueError, match="too large to check"):
        module.read_system("x", fields)


def test_the_largest_motions_without_contact_that_are_read():
    """Each of them is decided once, and once more for each force."""
    pull = {"numerators": [[1] * 10], "denominator": 1}
    contact = {"free": tens(50), "pulls": [pull], "required": False}
    fields = stored(systems.family([[1]])) | {
        "states": [f"x{i}" for i in range(10)],
        "modes": tens(1),
    }
    assert len(module.read_system("x", {**fields, "contact": contact}).contact.free) == 50
    with pytest.raises(ValueError, match="too large to check"):
        module.read_system("x", {**fields, "contact": {**contact, "pulls": [pull, pull]}})


def test_a_rule_for_misses_is_read_as_it_was_written():
    system = replace(systems.doubled_in_turns(3), clock=Clock(2, ("m0",), ((0, 1), (0, -1))))
    fields = module.system_fields(system)
    assert fields["clock"] == {"length": 2, "first": ["m0"], "ahead": [[0, 1], [0, -1]]}
    assert module.read_system(system.name, fields).clock == system.clock
    # An automaton of many states is no matrix that something is decided of.
    stays = systems.sheared_in_stays(300)
    fields = module.system_fields(stays)
    assert fields["clock"]["more"] == [["m1"]]
    assert module.read_system(stays.name, fields).clock == stays.clock


@by_rows("clock", "reason")
def test_malformed_turns(clock, reason):
    fields = module.system_fields(systems.doubled_in_turns(3))
    assert fields["clock"] == {"length": 3, "first": ["m0"]}
    with pytest.raises((TypeError, ValueError), match=reason):
        module.read_system("x", {**fields, "clock": clock})


def test_the_longest_rule_for_misses_is_read_and_no_longer_one():
    fields = module.system_fields(systems.doubled_in_turns(3))
    rule = {"length": 2, "first": ["m0"], "ahead": [[0, 1]] * 1001}
    with pytest.raises(ValueError, match="from 2 to 1000 steps or"):
        module.read_system("x", {**fields, "clock": rule})


def test_that_loss_must_be_covered_is_true_or_false():
    assert "required" not in stored(systems.bouncing())["contact"]
    fields = module.system_fields(systems.drifting())
    assert fields["contact"]["required"] is True
    assert module.read_system("family", fields) == systems.drifting()
    for wrong in (1, "true", None):
        changed = {**fields, "contact": {**fields["contact"], "required": wrong}}
        with pytest.raises(TypeError, match="expected true or false"):
            module.read_system("family", changed)


def test_how_contact_is_lost_is_written_beside_the_assumptions():
    bounce = systems.bouncing()
    system = replace(bounce, contact=replace(bounce.contact, loss=Assumption("as.goes")))
    fields = json.loads(json.dumps(module.system_fields(system)))
    assert (fields["contact"]["loss"], fields["assumptions"]) == ({"id": "as.goes"}, [])
    assert module.read_system(system.name, fields) == system
    for odd in ({"contact": 3}, {"contact": None}, {"clock": []}):
        with pytest.raises(TypeError, match="expected an object"):
            module.read_system(system.name, {**fields, **odd})
    for odd in ({"lost": ""}, {"loss": None}, {"free": None}):
        with pytest.raises((TypeError, ValueError)):
            module.read_system(system.name, {**fields, "contact": {**fields["contact"], **odd}})


@given(st.fractions(min_value="1/1000000", max_value=10**6))
def test_a_printed_rate_never_promises_more_than_the_proof(rate):
    # Decay of a continuous system is faster the larger alpha is, of a discrete one the smaller rho.
    slower, larger = (number_in(module.rate_text(rate, time)) for time in Time)
    assert slower <= rate <= larger
    assert abs(slower / rate - 1) < Fraction(1, 10**5)
