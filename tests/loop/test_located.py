"""Constant parameters of designs: which modes are one mode at their corners."""

from fractions import Fraction

import pytest

from nrs_design.errors import AssemblyError, InternalError
from nrs_design.loop import located
from nrs_design.loop import located as module
from nrs_design.proof.constant import corner_weights, system_at
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.switching import FixedParameter
from nrs_design.search.certification import Limits
from nrs_design.search.certify import Verdict, certify
from nrs_design.search.method import Method
from tests.loop.support import assembled
from tests.support import ROOT, words_of

SAMPLED = ROOT / "specs" / "neuroboscope" / "force-limit-pi-sampled.nrs.yaml"
CONTINUOUS = ROOT / "specs" / "neuroboscope" / "soft-tissue.nrs.yaml"
GAIN = "[4.744866e-4 rad/s/rpm, 4.938534e-4 rad/s/rpm]"
LAG = "[0.034398 s, 0.035802 s]"
STIFFNESS = "[720.56 N/m, 768.17 N/m]"
QUICK = Limits(optimize_rate=False, more=False)


def parameter(symbol, contact=None):
    said = FixedParameter(symbol, Fraction(0), Fraction(1))
    return module.ConstantParameter(said, (f"{symbol}-min", f"{symbol}-max"), contact)


def closed(*changes):
    return assembled(SAMPLED, *changes)


def constant(*ranges):
    return [(text, f"{text}, varies: false") for text in ranges]


def sets_of(names, *parameters):
    """The sets of modes with two names each, before the ends that they are at."""
    items = []
    for name in names:
        head, where, *labels = name.split("/")
        own = [p for p in parameters if p.contact in (None, where)]
        spot = module.Spot.from_names(head, where) + module.spot_of(labels, (), own)
        items.append(module.LocatedMode(head, spot, where, module.Period([[1]])))
    return [*module.constant_sets(items, parameters)]


def test_a_mode_is_the_same_at_the_ends_of_what_it_does_not_touch():
    names = ("a/x/k-min/Km-min", "a/x/k-min/Km-max", "a/x/k-max/Km-min", "a/x/k-max/Km-max")
    names += ("b/y/k-min/Km-min", "b/y/k-min/Km-max", "b/y/k-max/Km-min", "b/y/k-max/Km-max")
    sets = sets_of(names, parameter("k", "x"), parameter("Km"))
    assert sets == [
        ("a/x/k-min/Km-min", "a/x/k-min/Km-max", "a/x/k-max/Km-min", "a/x/k-max/Km-max"),
        ("b/y/k-min/Km-min", "b/y/k-min/Km-max") * 2,
        ("b/y/k-max/Km-min", "b/y/k-max/Km-max") * 2,
    ]


def test_a_contact_may_have_the_name_of_a_label():
    names = ("a/k-min/k-min", "a/k-min/k-max")
    assert sets_of(names, parameter("k", "k-min")) == [names]


def test_a_corner_without_a_mode_is_an_error():
    with pytest.raises(InternalError, match="no mode"):
        sets_of(("a/x/k-min",), parameter("k", "x"))


def test_too_many_corners(monkeypatch):
    monkeypatch.setattr(located, "MAX_CORNERS", 50)
    with pytest.raises(AssemblyError, match="corners of the constant parameters"):
        closed(*constant(GAIN, STIFFNESS))


def test_constants_of_a_sampled_design():
    """A time constant is enclosed by points around its curve, none of which is one of its own."""
    system = closed(*constant(GAIN, LAG, STIFFNESS))
    assert find_contradiction(system) is None
    said = [p.name for p in system.switching.fixed_parameters]
    assert said == ["actuator.gain", "actuator.time_constant", "environments.soft.stiffness"]
    assert {len(corners) for corners in system.switching.fixed_ends} == {2 * 3 * 2}
    with pytest.raises(ValueError, match="enclosed only"):
        system_at(system, (Fraction(1, 2),) * 3)
    assert sum("but constant" in text for text in words_of(system)) == 3


def test_the_loop_at_a_value_is_that_of_a_spec_with_this_value():
    """Gain and stiffness are attained: the mean of the corners is the loop at the mean."""
    system = closed(*constant(GAIN, STIFFNESS))
    found = {m.name: m.A for m in system_at(system, (Fraction(1, 2),) * 2).modes}
    gain, stiffness = "4.8417e-4 rad/s/rpm", "744.365 N/m"
    known = closed((GAIN, f"[{gain}, {gain}]"), (STIFFNESS, f"[{stiffness}, 768.17 N/m]"))
    named = "position/soft/k-min/flow-0"
    modes = {m.name: m.A for m in known.modes}
    assert found["position/soft/flow-0"] == modes[named]


def test_constants_of_a_continuous_design():
    text = CONTINUOUS.read_text(encoding="utf-8")
    stiffness = next(line for line in text.splitlines() if "range:" in line and "N/m" in line)
    ends = stiffness[stiffness.index("[") : stiffness.index("]") + 1]
    system = assembled(CONTINUOUS, *constant(ends))
    (parameter_,) = system.switching.fixed_parameters
    assert parameter_.name.endswith("stiffness")
    assert not parameter_.inverse
    assert find_contradiction(system) is None
    found = certify(system, Method.CONSTANTS_QUADRATIC, QUICK)
    assert found.verdict is Verdict.PROVED


@pytest.mark.slow
@pytest.mark.parametrize(("gain", "stiffness"), [("3.9e-4 to 5.8e-4", "600 to 900")])
def test_a_sampled_design_that_needs_constants(gain, stiffness):
    """No proof is found where both may jump at every sample, and there is one where they do not."""
    wide = [
        (GAIN, "[{} rad/s/rpm, {} rad/s/rpm]".format(*gain.split(" to "))),
        (STIFFNESS, "[{} N/m, {} N/m]".format(*stiffness.split(" to "))),
    ]
    varying = certify(closed(*wide), limits=QUICK)
    assert varying.verdict is Verdict.INCONCLUSIVE
    fixed = closed(*((old, f"{new}, varies: false") for old, new in wide))
    found = certify(fixed, limits=QUICK)
    assert found.verdict is Verdict.PROVED
    claim = found.evidence.claim(found.system)
    assert "constant value of actuator.gain and environments.soft.stiffness in" in claim
    assert "without rounding" in claim


def test_weights_of_corners_have_the_sum_one():
    shares = (Fraction(1, 3), Fraction(1, 4), Fraction(0))
    weights = corner_weights(shares)
    assert sum(weights) == 1
    assert weights[0] == Fraction(2, 3) * Fraction(3, 4)
    assert weights[1] == 0
