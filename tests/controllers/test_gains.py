"""Gains as text, and what a spec lets them be."""

from fractions import Fraction

import pytest

from nrs_design.controllers.float32 import is_float32
from nrs_design.controllers.gains import design_from_gains, gains_of
from nrs_design.errors import CertificateError, SpecError
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import read_spec
from tests.support import FORCE_LIMIT, SOFT_TISSUE
from tests.tables import rows

PATHS = {"impedance": SOFT_TISSUE, "force": FORCE_LIMIT}


def gains(kind="impedance"):
    loaded = read_spec(PATHS[kind])
    return loaded.spec, gains_of(run_design(loaded).design)


def altered(texts, controller, gain, value):
    return {**texts, controller: {**texts[controller], gain: value}}


@pytest.mark.parametrize("kind", PATHS)
def test_round_trip(kind):
    spec, texts = gains(kind)
    design = design_from_gains(spec, texts)
    assert gains_of(design) == texts
    assert design == run_design(read_spec(PATHS[kind])).design
    assert all(is_float32(Fraction(text)) for values in texts.values() for text in values.values())


@pytest.mark.parametrize(
    ("kind", "controller", "values", "said"), rows(__file__, "test_wrong_set_of_gains")
)
def test_wrong_set_of_gains(kind, controller, values, said):
    spec, texts = gains(kind)
    wrong = texts | {controller: values}
    if values is None:
        del wrong[controller]
    with pytest.raises(CertificateError, match=said):
        design_from_gains(spec, wrong)


@pytest.mark.parametrize(
    ("controller", "gain", "value", "reason"),
    rows(__file__, "test_gains_that_the_spec_does_not_allow"),
)
def test_gains_that_the_spec_does_not_allow(controller, gain, value, reason):
    spec, texts = gains()
    with pytest.raises(CertificateError, match=reason):
        design_from_gains(spec, altered(texts, controller, gain, value))


@pytest.mark.parametrize("value", ["nan", "inf", "", "1 ", "0x1", "one"])
def test_not_numbers(value):
    spec, texts = gains()
    with pytest.raises(SpecError):
        design_from_gains(spec, altered(texts, "insertion", "Bt", value))


def test_bounds_are_closed_after_rounding():
    spec, texts = gains()
    for value in ("20", "0.100000001490116119384765625"):
        design = design_from_gains(spec, altered(texts, "insertion", "Bt", value))
        assert design.controllers[0].law.Bt == Fraction(value)
