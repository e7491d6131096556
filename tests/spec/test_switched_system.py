from fractions import Fraction

import pytest

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


def _modes(count: int, n: int) -> str:
    row = "[" + ", ".join(["-1"] * n) + "]"
    matrix = "[" + ", ".join([row] * n) + "]"
    return "".join(f"  - {{name: m{i}, A: {matrix}}}\n" for i in range(count))


def test_dimension_is_limited() -> None:
    head = SWITCHED.partition("  - ")[0]
    tail = "switching: arbitrary\n"
    assert switched(head + _modes(1, 64) + tail).dimension == 64
    assert "more than 64 entries" in refusal(head + _modes(1, 65) + tail).message


@pytest.mark.slow
def test_number_of_modes_is_limited() -> None:
    head = SWITCHED.partition("  - ")[0]
    tail = "switching: arbitrary\n"
    assert len(switched(head + _modes(20_000, 1) + tail).modes) == 20_000
    assert "modes: more than 20000 entries" in refusal(head + _modes(20_001, 1) + tail).message
