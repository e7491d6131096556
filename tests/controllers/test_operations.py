"""A list of operations fits together, or is refused."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.controllers.operations import Coefficient
from tests.exporters.programs import law

ONE = Fraction(1)
TWO = Coefficient("two", "2", "1", (2 * ONE,))


def test_a_list_that_does_not_fit_is_refused():
    good = law()
    first, *others = good.operations
    sums = [operation for operation in good.operations if operation.kind == "subtract"]
    third = replace(good.coefficients[0], values=(Fraction(1, 3),))
    for change in (
        {"operations": (*others, first)},
        {"operations": (first, *good.operations)},
        {"operations": (*good.operations, replace(sums[0], name="more", kind="multiply"))},
        {"following": {}},
        {"outputs": {"command": "nothing"}},
        {"operations": (replace(first, second="nothing"), *others)},
        {"modes": ("one", "two", "three")},
        {"coefficients": (third, *good.coefficients[1:])},
    ):
        with pytest.raises(ValueError, match=r"\w"):
            replace(good, **change)


def test_a_coefficient_of_a_mode():
    several = Coefficient("a", "a", "1", (ONE, 2 * ONE))
    assert (several.differs_by_mode, TWO.differs_by_mode) == (True, False)
    assert [several.number(mode) for mode in (0, 1)] == [1, 2]
    assert [TWO.number(mode) for mode in (0, 1)] == [2, 2]
