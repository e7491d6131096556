from fractions import Fraction

import pytest

from nrs_design.spec.switching import DwellTime
from tests.tables import edited, spec_text

from .samples import SWITCHED, numbers, refusal, spoiled, switched


def test_reads_dayawansa_and_martin_exactly() -> None:
    spec = switched(SWITCHED)
    assert spec.time == "continuous"
    assert spec.dimension == 2
    assert [mode.name for mode in spec.modes] == ["a", "b"]
    assert numbers(spec.modes[1]) == [(-1, -6), (Fraction(1, 6), -1)]


def test_decimals_are_not_rounded() -> None:
    # The eigenvalue of this matrix is exactly 0 in decimal, not in binary arithmetic.
    text = spoiled(SWITCHED, "[[-1, -1], [1, -1]]", "[[-0.36, -0.48], [-0.48, -0.64]]")
    (a, b), (c, d) = numbers(switched(text).modes[0])
    assert a * d - b * c == 0


def test_a_matrix_needs_the_value_of_every_parameter() -> None:
    a, b = switched(spec_text("parameters")).modes
    assert a.matrix({"k": Fraction(1, 2)}) == [[0, 1], [Fraction(-5, 2), -1]]
    values = {"k": Fraction(4), "m": Fraction(1)}
    assert b.matrix(values) == [[0, 1], [Fraction(-5, 2), -1]]
    with pytest.raises(KeyError):
        b.matrix({"k": Fraction(1)})


def test_only_allowed_switches_need_a_reset() -> None:
    none = ["switching: arbitrary", "switching: {transitions: []}"]
    assert switched(edited(spec_text("unequal"), none).partition("resets:")[0]).resets == ()


def test_times_by_mode() -> None:
    rules = switched(spec_text("left")).switching
    assert rules.stay("a") == (None, DwellTime("1 step", Fraction(1), "steps"))
    assert [time.text for time in rules.stay("b")] == ["2 steps", "5 steps"]
    assert str(rules) == (
        "dwell time 2 steps in b, longest dwell time 1 step in a, longest dwell time 5 steps in b"
    )


HEAD, TAIL = SWITCHED.partition("  - ")[0], "switching: arbitrary\n"


def _modes(count: int, n: int) -> str:
    return "".join(f"  - {{name: m{i}, A: {[[-1] * n] * n}}}\n" for i in range(count))


def test_dimension_is_limited() -> None:
    assert switched(HEAD + _modes(1, 64) + TAIL).dimension == 64
    assert "more than 64 entries" in refusal(HEAD + _modes(1, 65) + TAIL).message


@pytest.mark.slow
def test_number_of_modes_is_limited() -> None:
    assert len(switched(HEAD + _modes(20_000, 1) + TAIL).modes) == 20_000
    assert "modes: more than 20000 entries" in refusal(HEAD + _modes(20_001, 1) + TAIL).message
