"""The system at one value of a constant parameter."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.loop.assemble import assemble_from_text
from nrs_design.proof.constant import find_odd_shares, name_between, system_at, value_at, value_text
from nrs_design.proof.switching import ARBITRARY, FixedParameter, Stay, Switching
from nrs_design.spec import parse_spec
from tests.proof.systems import PAIR, family, hidden_value
from tests.tables import by_rows, spec_text

TEXT = spec_text("constant-share")


def ends(*sets):
    return Switching(fixed_ends=tuple(map(tuple, sets)))


def assembled(rules="arbitrary"):
    return assemble_from_text(parse_spec(TEXT.replace("RULES", rules)), {})


@pytest.mark.parametrize("share", [Fraction(0), Fraction(1), Fraction(1, 3)])
def test_matrices_are_those_of_the_spec_at_that_value(share):
    spec, value = parse_spec(TEXT.replace("RULES", "arbitrary")), Fraction(1, 2) + share * 3 / 2
    found = system_at(assembled(), (share,))
    expected = {
        f"{mode.name}{end}": mode.matrix({"k": k, "m": value})
        for mode in spec.modes
        for end, k in ((("/k-min", 1), ("/k-max", 5)) if mode.name == "a" else (("", 3),))
    }
    assert {mode.name: mode.A.fractions() for mode in found.modes} == expected
    assert found.switching == ARBITRARY


def test_a_switch_that_one_end_forbids_is_forbidden():
    system = assembled()
    low, high = system.switching.fixed_ends[:2]
    for allowed, count in (
        ([(low[0], high[0]), (low[1], high[1])], 1),
        ([(low[0], high[0])], 0),
        ([(low[0], high[1]), (low[1], high[0])], 0),
    ):
        rules = Switching(transitions=tuple(allowed), fixed_ends=system.switching.fixed_ends)
        found = system_at(replace(system, switching=rules), (Fraction(1, 2),))
        assert len(found.switching.transitions) == count


def test_name_of_a_pair_is_what_its_ends_share():
    assert name_between("a/k-min/m-min", "a/k-min/m-max") == "a/k-min"
    assert name_between("low", "high") == "low to high"
    assert name_between("a/k-min", "a") == name_between("a", "a/k-min") == "a"


def test_nobody_switches_to_the_mode_that_one_is_in():
    system = hidden_value(1)
    rules = replace(system.switching, transitions=(("m0", "m0"), ("m1", "m1")))
    found = system_at(replace(system, switching=rules), (Fraction(1, 2),))
    assert found.switching.transitions == ()


@pytest.mark.parametrize("high", [[[-1, 0]], [[-1], [0]]])
def test_ends_of_different_sizes_are_an_error(high):
    system = family([[-1, 0], [0, -1]], high, switching=PAIR)
    with pytest.raises(ValueError, match="shorter"):
        system_at(system, (Fraction(1, 2),))


def test_a_stay_must_suit_both_ends():
    system = assembled()
    stays = (
        ("a/k-min/m-min", Stay(Fraction(1), Fraction(5))),
        ("a/k-min/m-max", Stay(Fraction(2), Fraction(9))),
    )
    found = system_at(
        replace(system, switching=replace(system.switching, stays=stays)), (Fraction(1),)
    )
    assert found.switching.stays == (("a/k-min", Stay(Fraction(2), Fraction(5))),)
    assert system_at(system, (Fraction(1),)).switching == ARBITRARY


@pytest.mark.parametrize(
    ("switching", "shares", "said"),
    [
        (Switching(), (Fraction(1),), "no parameter is constant"),
        ({}, (), "no share is given"),
        ({}, (Fraction(1), Fraction(0)), "not one share for each"),
        ({"enclosed": True}, (Fraction(1),), "values are enclosed only"),
        ({"twice": True}, (Fraction(1),), "not one share for each"),
        ({}, (Fraction(2),), "not between 0 and 1"),
        ({}, (Fraction(-1, 2),), "not between 0 and 1"),
        (ends("abcd"), (Fraction(1, 3), Fraction(2)), "not between 0 and 1"),
        (ends("abcd"), (Fraction(1, 3), Fraction(1)), None),
        (ends("abcdefgh"), (Fraction(1, 3), Fraction(1), Fraction(0)), None),
        (ends("abcdef"), (Fraction(1, 3), Fraction(1), Fraction(0)), "not one share for each"),
        (ends("ab", "abcd"), (Fraction(1, 3),), "not one share for each"),
        ({}, (Fraction(1, 3),), None),
    ],
)
def test_shares_are_those_of_a_value(switching, shares, said):
    if not isinstance(switching, Switching):
        known = assembled().switching
        (parameter,) = known.fixed_parameters
        named = (replace(parameter, enclosed=switching.get("enclosed", False)),)
        switching = replace(known, fixed_parameters=named * (1 + switching.get("twice", False)))
    found = find_odd_shares(switching, shares)
    assert found is None if said is None else said in found


def test_a_parameter_that_acts_by_its_inverse_has_values_between():
    """One over it is affine in the share: half way from 1 to 3 it is 3/2."""
    parameter = FixedParameter("J", Fraction(1), Fraction(3), inverse=True)
    assert value_at(parameter, Fraction(1, 2)) == Fraction(3, 2)
    assert value_at(replace(parameter, inverse=False), Fraction(1, 2)) == 2
    assert [value_at(parameter, Fraction(s)) for s in (0, 1)] == [1, 3]
    far = FixedParameter("J", Fraction(2), Fraction(4), "kg", inverse=True)
    assert value_at(far, Fraction(1, 3)) == Fraction(12, 5)
    named = replace(ends("ab"), fixed_parameters=(far, replace(parameter, name="k")))
    system = family([[1]], switching=named)
    shares = (Fraction(1, 3), Fraction(1))
    assert value_text(system, shares) == "At J = 2.4 kg and k = 3"
    unnamed = value_text(family([[1]], switching=ends("ab")), shares[:1])
    assert unnamed == "At 1/3 of the way from the low to the high end of the parameter"


def test_a_value_that_is_none_has_no_system():
    with pytest.raises(ValueError, match="no share is given"):
        system_at(assembled(), ())


@by_rows("corners", "enclosed", "found")
def test_enclosures_at_a_value(corners, enclosed, found):
    def named(*sets):
        return tuple(tuple(f"m{k}" for k in one) for one in sets)

    system = family(*([[k]] for k in range(6)), switching=ends(*named(*corners)))
    system = replace(system, enclosures=named(*enclosed))
    expected = tuple(
        tuple(f"m{a} to m{b}" for a, b in zip(*pair.split(), strict=True)) if pair else ()
        for pair in found
    )
    assert system_at(system, (Fraction(1, 2),)).enclosures == expected
