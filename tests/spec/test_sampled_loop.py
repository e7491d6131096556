"""What the sampled loop does not model is said while a spec is read, at its line."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from tests.support import FORCE_LIMIT, ROOT, SOFT_TISSUE, typed

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
FORCE = FORCE_LIMIT.read_text(encoding="utf-8")
OFFSET = (ROOT / "specs/neuroboscope/force-limit-offset.nrs.yaml").read_text(encoding="utf-8")
MIXED = (ROOT / "docs/examples/mixed-controllers.nrs.yaml").read_text(encoding="utf-8")
PARALLEL = (ROOT / "docs/examples/parallel.nrs.yaml").read_text(encoding="utf-8")
SAMPLED = "\nsampling: {period: 2 ms, delay: 0}\n"
BT = "Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad"
RANGED_SOFT = "{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}"
DAMPED = ("model: elastic", "model: kelvin-voigt\n    damping: 1 N*s/m")
SPRUNG = (BT, "Kt: 0.5 N*m/rad\n    " + BT)
LOSABLE = SAMPLED + "contact: losable\n"
ROUNDED = SAMPLED + "disturbances: {largest_angle: 20 deg}\n"
COMMANDED = SAMPLED + "disturbances: {command: 8 deg/s}\n"


def read(text, *changes):
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return parse_spec(text)


@pytest.mark.parametrize(
    ("text", "changes", "at", "said", "remedy"),
    [
        (
            TEXT + SAMPLED,
            [("model: elastic", "model: maxwell\n    damping: 20 N*s/m")],
            "environments.soft.model",
            "soft remembers",
            "leave sampling out",
        ),
        (
            TEXT + SAMPLED,
            [
                (RANGED_SOFT, "747.1461 N/m"),
                ("switching: arbitrary", "switching: {dwell_time: 1 s}"),
            ],
            "switching.dwell_time",
            "have dwell times",
            "or sampling",
        ),
        (TEXT + SAMPLED + "coordinates: force\n", [], "coordinates", "force coord", "deflection"),
        (PARALLEL + SAMPLED, [], ".type", "is a parallel controller", "use impedance"),
        (OFFSET + SAMPLED, [], "controllers.force.offset", "the offset of force", "offset: none"),
        (MIXED + LOSABLE, [], "contact", "impedance controllers beside others", "contact: kept"),
        (TEXT + LOSABLE, [DAMPED], "contact", "soft, which has damping", "contact: kept"),
        (FORCE + COMMANDED, [], "disturbances.command", "velocity command", "leave command out"),
        (MIXED + ROUNDED, [], "disturbances.largest_angle", "rounding of angles", "leave largest"),
        (TEXT + COMMANDED, [SPRUNG], "disturbances.command", "that the spring Kt", "or Kt"),
    ],
)
def test_what_is_not_modelled_is_refused_at_its_place(text, changes, at, said, remedy):
    with pytest.raises(SpecError, match=said) as caught:
        read(text, *changes)
    assert at in str(caught.value)
    assert "in the sampled loop" in str(caught.value)
    assert remedy in caught.value.remedy
    assert caught.value.line


def test_a_spring_in_one_controller_alone_does_not_lose_contact():
    first, second = TEXT.split("  withdrawal:")
    with pytest.raises(SpecError, match="some controllers have a spring Kt and some have none"):
        parse_spec(first.replace(*SPRUNG) + "  withdrawal:" + second + LOSABLE)


def test_without_sampling_none_of_this_is_refused():
    assert read(OFFSET)
    assert read(TEXT, ("model: elastic", "model: maxwell\n    damping: 20 N*s/m"))


def test_ranges_of_gains_and_force_control_are_read():
    assert read(TEXT + SAMPLED, (f"{BT}}}", f"{BT}, range: [1 N*m*s/rad, 3 N*m*s/rad]}}"))
    assert read(FORCE + SAMPLED)
    assert read(FORCE + LOSABLE)


def test_check_says_it_as_a_user_types_it(tmp_path):
    path = tmp_path / "offset.nrs.yaml"
    path.write_text(OFFSET + SAMPLED, encoding="utf-8")
    done = typed("check", path, cwd=tmp_path)
    assert done.returncode == 2
    assert "controllers.force.offset: in the sampled loop" in done.stderr
    assert "offset.nrs.yaml:42" in done.stderr
