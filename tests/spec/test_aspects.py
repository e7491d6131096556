"""What a spec may be proved without, part by part."""

import pytest

from nrs_design.spec import parse_spec
from nrs_design.spec.aspects import aspects_of
from tests.support import SOFT_TISSUE

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
BT = "Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad"
PARTS = {
    "the outer_period": "\nsampling: {period: 2 ms, outer_period: 4 ms, delay: 1}\n",
    "the loss of contact": "\ncontact: losable\n",
    "ages of the force sample beyond the shortest": "\nsampling: {period: 2 ms, delay: [1, 3]}\n",
    "the ranges of the motor": (
        "time_constant: 0.0351 s",
        "time_constant: {nominal: 0.0351 s, range: [0.034 s, 0.036 s]}",
    ),
    "the ranges of gains": (f"{BT}}}", f"{BT}, range: [1 N*m*s/rad, 3 N*m*s/rad]}}"),
}
TOUCHED = "the ranges of what is touched"


def text_with(*names: str) -> str:
    text = TEXT
    for name in names:
        change = PARTS[name]
        text = text.replace(*change) if isinstance(change, tuple) else text + change
    return text


@pytest.mark.parametrize("name", PARTS)
def test_a_part_is_named_where_it_is_there_and_can_be_left_out(name):
    assert set(aspects_of(parse_spec(TEXT))) == {TOUCHED}
    spec = parse_spec(text_with(name))
    aspects = aspects_of(spec)
    assert set(aspects) == {name, TOUCHED}
    assert set(aspects_of(aspects[name](spec))) == {TOUCHED}


def test_all_parts_can_be_left_out_together():
    text = text_with(*(name for name in PARTS if name != "the outer_period"))
    spec = parse_spec(text.replace("period: 2 ms,", "period: 2 ms, outer_period: 4 ms,"))
    aspects = aspects_of(spec)
    assert set(aspects) == {*PARTS, TOUCHED}
    for weaken in aspects.values():
        spec = weaken(spec)
    assert aspects_of(spec) == {}
    assert not spec.has_ranges
    assert (spec.sampling.delay, spec.contact) == ((1, 1), "kept")
    nominal = spec.environments["soft"].stiffness
    assert nominal.range == (nominal.nominal, nominal.nominal)


def test_axes_by_themselves():
    links = "coupling: {inertia: [0 kg*m^2, 0.3 kg*m^2]}\nactuator:\n  load_inertia: 1.213 kg*m^2\n"
    spec = parse_spec(TEXT.replace("actuator:\n", links))
    aspects = aspects_of(spec)
    assert set(aspects) == {TOUCHED, "what the axes do to each other"}
    alone = aspects["what the axes do to each other"](spec)
    assert alone.coupling is None
    assert alone.actuator == spec.actuator
