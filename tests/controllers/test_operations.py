"""A list of operations fits together, or is refused."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.controllers.operations import LINEAR, Coefficient, Operation, StepLaw, Value
from tests.exporters.programs import LAWS, law

ONE = Fraction(1)
X = Value("x", "x", "1", ONE, "an input")
TABLE = Coefficient("table", "", "1", (ONE, ONE, 2 * ONE), table=True)
TWO = Coefficient("two", "2", "1", (2 * ONE,))


def short(kind, left, right, coefficients=(TABLE, TWO), **others):
    """Return a law of one operation."""
    made = Operation("y", kind, left, right)
    units = {"out": "1"}
    return StepLaw((), (X,), (), coefficients, (made,), {"out": "y"}, {}, units, **others)


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
        {"checks": {"nothing": ONE}},
        {"checks": {good.operations[0].name: Fraction(1, 3)}},
        {"modes": ("one", "two", "three")},
        {"coefficients": (third, *good.coefficients[1:])},
    ):
        with pytest.raises(ValueError, match=r"\w"):
            replace(good, **change)


@pytest.mark.parametrize(
    ("kind", "left", "right"),
    [
        ("add", "two", "x"), ("multiply", "x", "x"), ("multiply", "table", "x"),
        ("interpolate", "two", "x"), ("interpolate", "x", "x"), ("product", "x", "two"),
        ("divide", "y", "x"), ("root", "", "nothing"),
    ],
)  # fmt: skip
def test_operands_of_another_kind_are_refused(kind, left, right):
    with pytest.raises(ValueError, match="y is"):
        short(kind, left, right)


@pytest.mark.parametrize(
    ("kind", "left"), [("interpolate", "table"), ("root", ""), ("rest", "two"), ("product", "x")]
)
def test_operands_that_fit(kind, left):
    assert short(kind, left, "x").operations[0].kind == kind


def test_a_table_has_two_entries_at_least():
    with pytest.raises(ValueError, match="some modes only"):
        short("root", "", "x", coefficients=(replace(TABLE, values=(ONE,)),))


def test_a_coefficient_of_a_mode():
    several = Coefficient("a", "a", "1", (ONE, 2 * ONE))
    assert (several.by_mode, TABLE.by_mode, TWO.by_mode) == (True, False, False)
    assert [several.of(mode) for mode in (0, 1)] == [1, 2]
    assert [TWO.of(mode) for mode in (0, 1)] == [2, 2]


def test_laws_of_one_axis_are_linear_and_guard_everything():
    for made in LAWS.values():
        assert {operation.kind for operation in made.operations} <= LINEAR
        assert made.guarded == made.values
        assert not made.checks
