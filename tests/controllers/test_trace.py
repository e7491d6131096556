"""Formulas recorded as operations: what they compute, what is folded, what is shared."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.operations import StepLaw, Value
from nrs_design.controllers.replica import step
from nrs_design.controllers.trace import Trace, Traced

LIMIT = Fraction(2) ** 100


def law_of(trace, result):
    """Return the law that computes a result from x and y."""
    inputs = tuple(Value(name, name, "1", LIMIT, "an input") for name in "xy")
    name = result.positive()
    operations = tuple(trace.used([name]))
    used = {operation.left for operation in operations}
    coefficients = tuple(c for c in trace.constants.values() if c.name in used)
    return StepLaw((), inputs, (), coefficients, operations, {"z": name}, {}, {"z": "1"})


def evaluated(formula, x, y):
    trace = Trace()
    law = law_of(trace, formula(trace.value("x"), trace.value("y")))
    made = {"x": np.float32([x]), "y": np.float32([y])}
    return float(step(law, np.zeros(1, np.uint32), made).outputs["z"][0])


FORMULAS = [
    lambda x, y: -x - y,
    lambda x, y: -(x - 2 * y) + 1,
    lambda x, y: 3 - (-x) * y,
    lambda x, y: -x / (2 - y * y - 5) / y,
    lambda x, y: 2 * (3 * x) - (-4) * (0.25 * y) + 0 * x,
    lambda x, y: 1 / (-x) + y / 4,
    lambda x, y: np.sqrt(x * x + y * y) * -1,
    lambda x, y: (1 / x) * y + y / x,
]


@pytest.mark.parametrize("formula", FORMULAS)
@given(x=st.floats(0.5, 2, width=32), y=st.floats(0.5, 2, width=32))
def test_a_recorded_formula_computes_the_formula(formula, x, y):
    assert evaluated(formula, x, y) == pytest.approx(formula(x, y), rel=1e-5, abs=1e-5)


def test_the_same_is_recorded_once():
    trace = Trace()
    x, y = trace.value("x"), trace.value("y")
    first, second = x * y + 1, y * x + 1
    assert first.name == second.name
    assert len(trace.operations) == 2


def test_numbers_are_folded_and_signs_cost_nothing():
    trace = Trace()
    x = trace.value("x")
    assert (2 * (-3 * x)).negative
    assert [float(c.values[0]) for c in trace.constants.values()] == [3, 6]
    made = law_of(trace, -(2 * (-3 * x)) + trace.value("y"))
    assert [operation.kind for operation in made.operations] == ["multiply", "add"]
    for nothing in (0 * x, 0 / x, x - x):
        assert nothing == 0.0
    for same in (x + 0, 1 * x, x / 1, 0 + x):
        assert isinstance(same, Traced)
        assert (same.name, same.negative) == ("x", False)


def test_a_reciprocal_that_is_there_is_used_again():
    trace = Trace()
    x, y = trace.value("x"), trace.value("y")
    inverse = 1 / x
    assert [o.kind for o in trace.operations] == ["invert"]
    assert (y / x).name == (y * inverse).name


def test_what_leads_to_no_result_is_left_out():
    trace = Trace()
    x, y = trace.value("x"), trace.value("y")
    wanted, _ = x + y, x * y
    assert [o.kind for o in trace.used([wanted.name])] == ["add"]


def test_every_operation_follows_its_operands():
    """In an order that is not that of recording."""
    trace = Trace()
    x, y = trace.value("x"), trace.value("y")
    value = x
    for k in range(30):
        value = value * y + (x * (k + 2)) / (value * value + 1)
    assert law_of(trace, value).operations
