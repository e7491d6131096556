"""Rules of switching and resets, in both kinds of specs."""

from fractions import Fraction

from nrs_design.spec.switching import DwellTime
from tests.tables import edited, spec_text

from .samples import switched


def test_only_allowed_switches_need_a_reset() -> None:
    none = ["switching: arbitrary", "switching: {transitions: []}"]
    assert switched(edited(spec_text("unequal"), none).partition("resets:")[0]).resets == ()


def test_times_by_mode() -> None:
    rules = switched(spec_text("left")).switching
    two, one = DwellTime("2 steps", Fraction(2), "steps"), DwellTime("1 step", Fraction(1), "steps")
    assert rules.stay("a") == (None, one)
    assert rules.stay("b") == (two, DwellTime("5 steps", Fraction(5), "steps"))
    assert not rules.is_arbitrary
    assert str(rules) == (
        "dwell time 2 steps in b, longest dwell time 1 step in a, longest dwell time 5 steps in b"
    )
