"""Limits of contact with people: what belongs together, and where a number is from."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from nrs_design.spec.document import parse_document, to_data
from nrs_design.spec.weaker import find_changes
from tests.support import SOFT_TISSUE

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
REGION = {"name": "hand", "source": "an example", "lever_arm": "0.24 m"}
MASSES = {"robot_mass": "3 kg", "body_mass": "0.6 kg"}


def spec_text(*regions):
    written = ", ".join(
        "{" + ", ".join(f"{key}: {value}" for key, value in region.items()) + "}"
        for region in regions
    )
    assert "  bandwidth: 2 Hz\n" in TEXT
    return TEXT.replace("  bandwidth: 2 Hz\n", f"  bandwidth: 2 Hz\n  contact: [{written}]\n")


def test_a_region_with_all_of_it():
    spec = parse_spec(
        spec_text(
            REGION
            | MASSES
            | {"environment": "soft", "quasi_static_force": "140 N", "energy": "0.5 J"}
            | {"transient_pressure": "380 N/cm^2", "contact_area": "1 cm^2"}
            | {"stiffness": "75 N/mm", "body_speed": "0.1 m/s", "hic": "100", "speed": "1 m/s"}
        )
    )
    (region,) = spec.limits.contact
    assert region.transient_pressure.exact == 3_800_000
    assert region.stiffness.exact == 75_000


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "no limit of the region 'hand' is given"),
        ({"transient_pressure": "380 N/cm^2"}, "without an area"),
        ({"speed": "1 m/s", "contact_area": "1 cm^2"}, "no pressure that the area is for"),
        ({"quasi_static_force": "140 N"}, "no environment says how the region yields"),
        ({"quasi_static_force": "140 N", "environment": "bone"}, "bone"),
        ({"energy": "0.5 J"}, "energy is given without robot_mass"),
        ({"transient_force": "280 N"} | MASSES, "transient_force is given without stiffness"),
        ({"transient_force": "280 N*m"}, "N*m"),
        (
            {"transient_pressure": "380 N", "contact_area": "1 cm^2"},
            "divide it by the area and write N/cm^2",
        ),
        ({"transient_pressure": "380 N/cm^2", "contact_area": "1 cm"}, "that is a length"),
        ({"speed": "1 m/s", "contact_area": "0 cm^2"}, "must be positive"),
        ({"speed": "1 m/s", "source": "' '"}, "nothing says where the limits are from"),
    ],
)
def test_what_does_not_belong_together_is_refused(changes, words):
    with pytest.raises(SpecError, match=r"limits\.contact") as caught:
        parse_spec(spec_text(REGION | changes))
    assert words in str(caught.value)


def test_a_source_must_be_named():
    named = {key: value for key, value in REGION.items() if key != "source"}
    with pytest.raises(SpecError, match="source"):
        parse_spec(spec_text(named | {"speed": "1 m/s"}))


def test_a_region_is_listed_once():
    with pytest.raises(SpecError, match="'hand' is there twice"):
        parse_spec(spec_text(*[REGION | {"speed": "1 m/s"}] * 2))


@pytest.mark.parametrize(
    ("key", "before", "after", "weaker"),
    [
        ("energy", "0.5 J", "0.6 J", True),
        ("energy", "0.5 J", "0.4 J", False),
        ("robot_mass", "3 kg", "2 kg", True),
        ("robot_mass", "3 kg", "4 kg", False),
        ("body_mass", "0.6 kg", "0.7 kg", True),
        ("body_speed", "0.2 m/s", "0.1 m/s", True),
    ],
)
def test_what_allows_for_more_is_a_weakening(key, before, after, weaker):
    base = REGION | MASSES | {"energy": "0.5 J", "body_speed": "0.2 m/s"}
    texts = (spec_text(base | {key: value}) for value in (before, after))
    old, new = (to_data(parse_document(text)) for text in texts)
    changes = [change for change in find_changes(old, new) if change.at[-1] == key]
    assert [change.weaker for change in changes] == [weaker]
