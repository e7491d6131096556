"""What follows from operations: linear forms, roundings of terms, bounds of results."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.controllers.step_analysis import check_range, rounded_terms
from nrs_design.errors import DesignError
from nrs_design.models.linear_form import combine, coordinates
from tests.controllers.roundings import linear_forms, term_counts
from tests.exporters.programs import LAWS, law

ONE = Fraction(1)
X, Y = (Value(name, name, "1", ONE, "an input") for name in "xy")
HALF = Coefficient("h", "h", "1", (Fraction(1, 2),))


def of(*operations, coefficients=(HALF,)):
    """Return a law whose last operation is its output."""
    last = operations[-1].name
    return StepLaw(("a",), (X, Y), (), coefficients, operations, {"o": last}, {}, {"o": "1"})


def test_counts_by_hand():
    """The difference of exact numbers rounds once for itself, then its product, then the sum."""
    made = of(
        Operation("d", "subtract", "x", "y"),
        Operation("p", "multiply", "h", "d"),
        Operation("z", "add", "p", "y"),
    )
    assert term_counts(made) == {"h (x - y)": 3, "y": 1}


def test_products_with_zero_and_one_are_exact():
    for factor, expected in ((0, {}), (1, {"(x + y)": 1})):
        exact = Coefficient("h", "h", "1", (Fraction(factor),))
        made = of(
            Operation("d", "add", "x", "y"),
            Operation("p", "multiply", "h", "d"),
            coefficients=(exact,),
        )
        assert term_counts(made) == expected


@pytest.mark.parametrize("shape", sorted(LAWS))
def test_every_term_of_a_sum_adds_up_to_it(shape):
    """What a result is a sum of is, without roundings, that result."""
    made = LAWS[shape]
    unit = coordinates(len(made.values))
    given = {value.name: form for value, form in zip(made.values, unit, strict=True)}
    for mode in range(len(made.modes)):
        forms = linear_forms(made, mode, given)
        for name, terms in rounded_terms(made, mode, given).items():
            total = combine(*((ONE, term.form) for term in terms)) if terms else [0] * len(unit)
            assert total == list(forms[name])


@pytest.mark.parametrize(("exponent", "fits"), [(106, True), (107, False), (127, False)])
def test_a_law_that_could_leave_single_precision_is_refused(exponent, fits):
    """An error of up to 2e6 rad, just below 2^21, times a gain has to stay below 2^127."""
    made = law()
    Kp, *others = made.coefficients
    large = replace(made, coefficients=(replace(Kp, values=(Fraction(2**exponent),)), *others))
    if fits:
        check_range(large)
        return
    with pytest.raises(DesignError, match="beyond single precision"):
        check_range(large)
