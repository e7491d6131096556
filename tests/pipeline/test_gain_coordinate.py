"""Values near a gain that a spec may give, and the bounds of gains that are free by factors."""

from fractions import Fraction
from math import log

from hypothesis import given
from hypothesis import strategies as st

from nrs_design.pipeline.gain_coordinate import GainCoordinate, bounded_gain, freed_gains
from nrs_design.pipeline.runs import run_interaction
from nrs_design.spec import read_spec
from tests.support import ROOT

from .free import freed

ZERO = Fraction(0)


def coordinate(low, high, given=None):
    return GainCoordinate("motion", "Kp", "rpm/rad", Fraction(low), Fraction(high), given=given)


def test_the_nearest_number_of_so_few_digits():
    one = coordinate("0.5", 2, Fraction(1))
    assert one.near(log(1.2345), 3) == [(Fraction("1.23"), "1.23 rpm/rad")]
    # On a bound that is no such number, the next one inside.
    assert one.near(log(2), 1) == [(2.0, "2 rpm/rad")]
    assert coordinate("0.5", "1.2345", Fraction(1)).near(log(1.2345), 3)[0][0] == Fraction("1.23")
    # Bounds nearer to each other than such numbers leave what is given.
    narrow = coordinate("1.2341", "1.2349", Fraction("1.2345"))
    assert narrow.near(log(1.2345), 2) == [(Fraction("1.2345"), "1.2345 rpm/rad")]


@given(st.floats(-2, 2), st.integers(1, 7))
def test_what_is_near_is_within_the_bounds(x, digits):
    one = coordinate("0.3", 3, Fraction(1))
    for value, text in one.near(x, digits):
        assert one.low <= Fraction(text.split()[0]) <= one.high
        assert value == Fraction(text.split()[0])
        assert abs(log(value) - min(max(x, one.ends[0]), one.ends[1])) < 0.8


def test_which_bound_it_is_on():
    one = coordinate("0.5", 2, Fraction(1))
    assert [one.at_bound(log(v)) for v in (0.5, 1, 2)] == ["lower", None, "upper"]
    # Bounds that a spec gives by themselves are told elsewhere.
    assert coordinate("0.5", 2).at_bound(log(2)) is None


def test_bounds_of_the_spec_and_factors():
    designed = freed("motion: {Kp: {min: 0.6, max: 1.6}}")
    given = designed.spec.controllers["insertion"].Bt
    Bt = bounded_gain("insertion", "Bt", given, given.min.exact, "N*m*s/rad")
    assert (Bt.low, Bt.high) == (Fraction("0.1"), 20)
    assert bounded_gain("insertion", "Mt", given, ZERO, "N*m*s/rad") is None
    (Kp,) = freed_gains(designed)
    assert Kp.name == ("motion", "Kp")
    assert Kp.high == Fraction("1.6") * designed.design.motion.Kp


def test_an_example_that_is_free_in_nothing_is_left(tmp_path):
    path = ROOT / "specs" / "neuroboscope" / "soft-tissue-redesigned.nrs.yaml"
    assert [*freed_gains(run_interaction(read_spec(path), ""))] == []
