"""Evidence of kind unstable-value: what a constant parameter may be, and what it may not do."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.certificates.certificate import CommonQuadraticStatus, Verdict
from nrs_design.proof.evidence import (
    UnstableMixture,
    UnstableMode,
    UnstablePeriod,
    UnstableValue,
)
from nrs_design.proof.mode import Time
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.switching import FixedParameter, Switching
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.search.gradient_settings import Gradient
from tests.proof.graphs import common_quadratic
from tests.proof.systems import (
    PAIR,
    PAIRS,
    branicky,
    family,
    genuine,
    hidden_shears,
    hidden_value,
    resets_between,
)
from tests.proof.truth import holds

HALF = Fraction(1, 2)
MIDDLE = UnstableValue(HALF, UnstableMode("m0 to m1", "0.5"))
FAST = Limits(max_degree=4, budget=600.0, gradient=Gradient(max_updates=100), optimize_rate=False)


@pytest.mark.parametrize("time", Time)
@pytest.mark.parametrize(("strength", "stable"), [("1.9", True), ("2.1", False), (50, False)])
def test_known_limit(time, strength, stable):
    """Eigenvalues -1 +- c sqrt(s (1 - s)), in discrete time without the -1: stable iff c < 2."""
    system = hidden_value(strength, time)
    found = certify(system, limits=FAST)
    if stable:
        assert found.verdict is not Verdict.REFUTED
        assert MIDDLE.find_fault(system) is not None
        return
    assert found.verdict is Verdict.REFUTED
    assert found.common_quadratic is CommonQuadraticStatus.IMPOSSIBLE
    assert isinstance(found.evidence, UnstableValue)
    assert 0 < found.evidence.share < 1
    assert holds(system, found.evidence)


@pytest.mark.parametrize("time", Time)
def test_exactly_on_the_border_at_one_value_only(time):
    """With c = 2 every value but the one in the middle is stable: a matter of exactness."""
    system = hidden_value(2, time)
    found = certify(system, limits=FAST)
    assert found.evidence.share == HALF
    assert UnstableValue(HALF + Fraction(1, 2**60), found.evidence.part).find_fault(system)


@pytest.mark.parametrize("share", ["1/3", "0", "1", "5/11", "-1/2", "3/2"])
def test_only_the_share_at_which_it_is_unstable(share):
    system = hidden_value("2.005")
    assert MIDDLE.find_fault(system) is None
    assert replace(MIDDLE, share=Fraction(share)).find_fault(system) is not None


def test_shares_are_short():
    system = hidden_value(3)
    for bits, fault in ((63, False), (64, False), (65, True)):
        near = replace(MIDDLE, share=HALF + Fraction(1, 2**bits))
        assert (near.find_fault(system) is not None) is fault


@pytest.mark.parametrize(
    ("share", "holds"), [("-1/9", False), (0, True), ("1/2", True), ("4/7", False), (1, False)]
)
def test_both_ends_are_values_too(share, holds):
    """``x' = (1 - 2 s) x`` is unstable for s up to 1/2."""
    share, part = Fraction(share), UnstableMode("m0 to m1", "1")
    system, other_way = (
        family(*ends, switching=PAIR) for ends in ([[[1]], [[-1]]], [[[-1]], [[1]]])
    )
    assert (UnstableValue(share, part).find_fault(system) is None) is holds
    assert (UnstableValue(1 - share, part).find_fault(other_way) is None) is holds


@pytest.mark.parametrize("share", ["3/2", "18446744073709551617/36893488147419103232"])
def test_shares_out_of_bounds_are_not_read(share):
    fields = {**MIDDLE.to_fields(), "share": share}
    with pytest.raises(ValueError, match="out of bounds"):
        UnstableValue.from_fields(fields, hidden_value(3))
    with pytest.raises(ValueError, match="no parameter is constant"):
        UnstableValue.from_fields(
            MIDDLE.to_fields(), replace(hidden_value(3), switching=Switching())
        )
    assert UnstableValue.from_fields(MIDDLE.to_fields(), hidden_value(3)).share == HALF


def test_a_parameter_that_is_not_declared_constant_has_no_such_value():
    ends = [mode.A.fractions() for mode in hidden_value(3).modes]
    assert "does not cover this kind of switching" in MIDDLE.find_fault(family(*ends))
    assert MIDDLE.find_fault(family(*ends, ends[0], switching=PAIR)) is not None


@pytest.mark.parametrize("time", Time)
def test_a_value_at_which_switching_is_unstable(time):
    system = hidden_shears(time)
    found = certify(system, limits=FAST)
    assert found.verdict is Verdict.REFUTED
    evidence = found.evidence
    kind = UnstableMixture if time is Time.CONTINUOUS else UnstablePeriod
    assert isinstance(evidence, UnstableValue)
    assert isinstance(evidence.part, kind)
    assert holds(system, evidence)
    assert agrees(system, evidence)
    # At the ends switching is stable, and without one value for both it would be no refutation.
    for end in (Fraction(0), Fraction(1)):
        assert replace(evidence, share=end).find_fault(system) is not None


def test_every_mode_has_the_same_value():
    # At any one value, the first mode has no shear or the second has none.
    up, down = [[-1, 10], [0, -1]], [[-1, 0], [10, -1]]
    rest = [[-1, 0], [0, -1]]
    system = family(rest, up, rest, rest, switching=PAIRS)
    found = certify(system, limits=FAST)
    assert found.verdict is Verdict.PROVED
    apart = family(up, rest, rest, down, switching=PAIRS)
    signal = UnstablePeriod((("m0 to m1", HALF), ("m2 to m3", HALF)), 6)
    for share in (Fraction(0), Fraction(1)):
        assert UnstableValue(share, signal).find_fault(apart) is not None


def test_rules_of_switching_hold_at_a_value_too():
    rows = [mode.A.fractions() for mode in hidden_shears(Time.DISCRETE).modes]
    signal = UnstablePeriod((("m0 to m1", Fraction(1)), ("m2 to m3", Fraction(1))), 3)
    evidence = UnstableValue(HALF, signal)
    there, back = [("m0", "m2"), ("m1", "m3")], [("m2", "m0"), ("m3", "m1")]
    for rules, fault in (
        ({}, False),
        ({"transitions": (*there, *back)}, False),
        ({"transitions": tuple(there)}, True),
        ({"transitions": (*there, back[0])}, True),
        ({"dwell_time": Fraction(2)}, True),
    ):
        system = family(*rows, time=Time.DISCRETE, switching=replace(PAIRS, **rules))
        assert (evidence.find_fault(system) is not None) is fault, rules


def test_resets_are_not_covered_unless_nothing_switches():
    resets = resets_between(("m0", "m2", [[0, 0], [0, 0]]))
    rows = [mode.A.fractions() for mode in hidden_shears(Time.DISCRETE).modes]
    system = family(*rows, time=Time.DISCRETE, switching=replace(PAIRS, resets=resets))
    signal = UnstablePeriod((("m0 to m1", Fraction(1)), ("m2 to m3", Fraction(1))), 3)
    assert UnstableValue(HALF, signal).find_fault(system) is not None
    pair = [mode.A.fractions() for mode in hidden_value(3).modes]
    idle = [[[-1, 0], [0, -1]]] * 2
    alone = family(*pair, *idle, switching=replace(PAIRS, resets=resets))
    assert MIDDLE.find_fault(alone) is None


def test_parts_of_other_kinds_show_nothing():
    stable = common_quadratic(((1, 0), (0, 1)), 0, Fraction(1, 4))
    assert UnstableValue(HALF, stable).find_fault(hidden_value(1)) is not None
    nested = UnstableValue(HALF, MIDDLE)
    assert nested.find_fault(hidden_value(3)) is not None
    with pytest.raises(ValueError, match="not of a kind"):
        UnstableValue.from_fields(
            {"share": "1/2", "part": {"kind": "unstable-value", **MIDDLE.to_fields()}},
            hidden_value(3),
        )


def test_claim_names_the_value():
    system = hidden_value(3)
    assert MIDDLE.claim(system).startswith("At 1/2 of the way from the low to the high end")
    parameter = FixedParameter("k", Fraction(10), Fraction("10.5"))
    named = replace(system, switching=replace(PAIR, fixed_parameter=parameter))
    assert MIDDLE.claim(named).startswith("At k = 10.25, which the range allows and which does not")
    assert "Mode m0 to m1 is not Hurwitz" in MIDDLE.claim(named)


def test_ends_of_other_systems_are_no_ends():
    _, evidence = genuine("unstable-value")
    wrong = Switching(fixed_ends=(("m0", "m9"),))
    for switching in (wrong, Switching(fixed_ends=(("m0", "m0"),)), Switching()):
        assert evidence.find_fault(replace(branicky(), switching=switching)) is not None


def test_a_narrow_window_between_two_points_of_the_grid():
    """Unstable within 0.00095 of one share only, while the grid has steps of 0.0039."""
    share = Fraction(70711, 100_000)
    low = [["-1", -1000 * share], [1000 * share, "0.9"]]
    high = [["-1", 1000 * (1 - share)], [-1000 * (1 - share), "0.9"]]
    system = family(low, high, switching=PAIR)
    # Trace -0.1, determinant (1000 (s - share))^2 - 0.9: Hurwitz unless |s - share| <= 0.00094868.
    found = certify(system, limits=FAST)
    assert isinstance(found.evidence, UnstableValue)
    assert abs(found.evidence.share - share) < Fraction("0.00095")
