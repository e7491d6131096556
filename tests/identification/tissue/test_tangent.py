"""A power law about a preload."""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest

from nrs_design.identification.errors import DataError
from nrs_design.identification.tissue.identify import identify_tissue
from nrs_design.identification.tissue.tangent import check_preload
from nrs_design.identification.write_spec import merge_tissue
from nrs_design.models.contact import Elastic, HuntCrossley
from nrs_design.spec import parse_spec, read_spec
from tests.identification.support import quick, record
from tests.support import SOFT_TISSUE

LAW = HuntCrossley(1500.0, 3000.0, 1.2)
PRELOAD = (0.002, 0.004)


@cache
def identified(count):
    data = [record(LAW, quick(seed), 0.02, seed) for seed in range(count)]
    return identify_tissue(data, "hunt-crossley", preload=PRELOAD)


@pytest.mark.parametrize("count", [1, pytest.param(3, marks=pytest.mark.slow)])
def test_the_true_tangents_are_in_the_range(count):
    stiffness, damping = identified(count).tangent.ranges
    for depth in (0.002, 0.003, 0.004):
        k, b = LAW.tangent(depth)
        assert stiffness.covers(k)
        assert damping.covers(b)
    assert stiffness.high / stiffness.low < 3


def written(found):
    text = merge_tissue(read_spec(SOFT_TISSUE), found, None, None).text
    soft = parse_spec(text).environments["soft"]
    for quantity, true in zip((soft.stiffness, soft.damping), LAW.tangent(0.003), strict=True):
        low, high = quantity.range
        assert low.si < true < high.si
    return text, soft


@pytest.mark.slow
def test_it_is_written_as_the_law_that_it_is():
    text, soft = written(identified(2))
    assert (soft.model, soft.linearized_about) == ("hunt-crossley", None)
    assert [soft.about.si, *(end.si for end in soft.preload)] == [0.003, 0.002, 0.004]
    assert soft.exponent.range[0] <= Fraction("1.2") <= soft.exponent.range[1]
    # Every tangent of the true law is in the box, and the chord from the surface.
    box, arm = soft.linear_at_pivot(), float(soft.lever_arm.exact**2)
    for depth in PRELOAD:
        k, b = LAW.tangent(depth)
        assert box["stiffness"].low < k / LAW.phi * arm < k * arm < box["stiffness"].high
        assert box["damping"].low < b * arm < box["damping"].high
    # Written again as another law, its keys are gone.
    elastic = identify_tissue([record(Elastic(750.0), quick(), 0.1)], "elastic")
    loaded = replace(read_spec(SOFT_TISSUE), text=text, spec=parse_spec(text))
    text = merge_tissue(loaded, elastic, None, None).text
    plain = parse_spec(text).environments["soft"]
    assert plain.model == "elastic"


@pytest.mark.slow
def test_an_exponent_that_may_be_below_one_leaves_a_spring_and_a_damper():
    """Such a law is not convex, and its chords are not those that a spec covers."""
    found = identified(2)
    *power, exponent = found.tangent.power
    about = replace(found.tangent, power=(*power, replace(exponent, low=0.9)))
    _, soft = written(replace(found, tangent=about))
    assert soft.model == "kelvin-voigt"
    assert soft.linearized_about == "deflections of 0.002 to 0.004 m"


def test_a_linear_law_has_none():
    with pytest.raises(DataError, match="the same at every preload"):
        identify_tissue([record(Elastic(750.0), quick(), 0.1)], "elastic", preload=PRELOAD)


@pytest.mark.parametrize("preload", [(0.0, 0.001), (0.001, 0.02)])
def test_beyond_the_record(preload):
    with pytest.raises(DataError, match="are not within the deflections"):
        check_preload(HuntCrossley, [fit.trial for fit in identified(1).model.fits], preload)
