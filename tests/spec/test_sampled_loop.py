"""What the sampled loop does not model is said while a spec is read, at its line."""

from fractions import Fraction

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
OUTER = "\nsampling: {period: 2 ms, outer_period: 0.1 ms, delay: 0}\n"
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
            "dwell times in the rules",
            "or sampling",
        ),
        (
            TEXT + SAMPLED,
            [
                (RANGED_SOFT, "747.1461 N/m"),
                ("switching: arbitrary", "switching: {dwell_time: 200 steps}"),
            ],
            "switching.dwell_time",
            "dwell times in the rules",
            "or sampling",
        ),
        (TEXT + SAMPLED + "coordinates: force\n", [], "coordinates", "force coord", "deflection"),
        (PARALLEL + SAMPLED, [], ".type", "is a parallel controller", "use impedance"),
        (OFFSET + SAMPLED, [], "controllers.force.offset", "the offset of force", "offset: none"),
        (MIXED + LOSABLE, [], "contact", "impedance controllers beside others", "contact: kept"),
        (FORCE + OUTER, [], "sampling.outer_period", "beside position", "leave outer_period"),
        (
            TEXT + OUTER,
            [("switching: arbitrary", "switching: {transitions: [[insertion, withdrawal]]}")],
            "switching",
            "rules of switching beside",
            "switching: arbitrary",
        ),
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


def test_loss_of_damped_contact_is_read():
    assert read(TEXT + LOSABLE, DAMPED)


@pytest.mark.parametrize(
    ("outer", "round_", "step"),
    [
        ("0.1 ms", 20, "1/10000"),
        ("2 ms", 1, "1/500"),
        ("10 ms", 5, "1/500"),
        ("0.04 ms", 50, "1/25000"),
    ],
)
def test_periods_that_meet(outer, round_, step):
    sampling = read(TEXT + OUTER.replace("0.1 ms", outer)).sampling
    assert (sampling.round, sampling.step) == (round_, Fraction(step))
    assert sampling.outer == sampling.outer_period.exact


@pytest.mark.parametrize(
    ("outer", "said"),
    [("0.3 ms", "whole number"), ("3 ms", "whole number"), ("0.02 ms", "is 100 of the other")],
)
def test_periods_that_do_not_meet(outer, said):
    with pytest.raises(SpecError, match=said) as caught:
        read(TEXT + OUTER.replace("0.1 ms", outer))
    assert "sampling.outer_period" in str(caught.value)
    assert "1 to 50 periods" in caught.value.remedy


def test_a_delay_counts_samples_of_the_force():
    text = TEXT + OUTER.replace("delay: 0", "delay: [0, 3]")
    assert read(text).sampling.oldest == Fraction(3, 10_000)
    assert read(text, (", outer_period: 0.1 ms", "")).sampling.oldest == Fraction(3, 500)


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
