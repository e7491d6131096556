"""The units of an axis, and which axis words are about."""

import pytest

from nrs_design.controllers.laws import LAWS
from nrs_design.errors import InternalError, SpecError
from nrs_design.models.axis import AxisType, axis_context, current, find_axis, labelled, unit
from nrs_design.spec import parse_spec
from nrs_design.spec.templates import PRISMATIC, TEMPLATES
from nrs_design.spec.units import parse_unit
from tests.tables import rows

SLIDE = AxisType.PRISMATIC
TEXT = TEMPLATES[PRISMATIC["interaction-design"]]


@pytest.mark.parametrize(
    ("turning", "sliding"), rows(__file__, "test_units_are_those_without_the_lever")
)
def test_units_are_those_without_the_lever(turning, sliding):
    assert SLIDE.unit(turning) == sliding
    assert AxisType.ROTARY.unit(turning) == turning


def test_every_gain_of_a_law_has_a_unit_on_both():
    for law in LAWS.values():
        for said in law.units.values():
            dimension = parse_unit(SLIDE.unit(said)).dimension
            # No radian is left.
            assert dimension[3] == 0


def test_a_unit_that_nobody_knows_is_never_passed_on():
    with pytest.raises(InternalError, match="no unit of an axis"):
        SLIDE.unit("N*m*rad")


def test_states_carry_their_axis():
    assert SLIDE.label("vm [rad/s]") == "vm [m/s]"
    assert SLIDE.label("k limit [N·m/rad], worst") == "k limit [N/m], worst"
    assert SLIDE.label("xp2") == "xp2"
    assert find_axis(["e [m]", "omega [m/s]"]) is SLIDE
    assert find_axis(["e [rad]", "F 1 before [N*m]"]) is AxisType.ROTARY


def test_words_are_about_one_axis_at_a_time():
    assert unit("N*m") == "N*m"
    with axis_context("prismatic"):
        assert (unit("N*m"), labelled("Torque [N m]"), current().fine) == ("N", "Torque [N]", 1000)
        with axis_context(AxisType.ROTARY):
            assert unit("N*m") == "N*m"
        with axis_context({"no": "axis"}):
            assert current() is AxisType.ROTARY
        assert current() is SLIDE
    assert current() is AxisType.ROTARY


@pytest.mark.parametrize(
    ("old", "new", "what"),
    rows(__file__, "test_quantities_of_the_other_axis_are_refused_with_a_remedy"),
)
def test_quantities_of_the_other_axis_are_refused_with_a_remedy(old, new, what):
    assert old in TEXT
    with pytest.raises(SpecError) as caught:
        parse_spec(TEXT.replace(old, new, 1))
    faults = caught.value.faults or (caught.value,)
    assert what in " ".join(f"{fault.message} {fault.remedy}" for fault in faults)
    assert all(fault.remedy for fault in faults)
