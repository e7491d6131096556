"""A law in C: a line for each operation in its order, and guards that let nothing else through."""

from fractions import Fraction

from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.c_step import definitions, guards
from tests.exporters.programs import LAWS

NAMES = CNames("some-law")
X = Value("x", "x", "rad", Fraction(2), "an input")
HALF = Coefficient("h", "h", "1", (Fraction(1, 2),))
TABLE = Coefficient("table", "t", "1", (Fraction(1), Fraction(2), Fraction(4)), table=True)


def body(law):
    return definitions(law, NAMES)


def of(*operations, coefficients=(HALF,), **others):
    last = operations[-1].name
    return StepLaw((), (X,), (), coefficients, operations, {"o": last}, {}, {"o": "rad"}, **others)


def test_helpers_are_there_where_they_are_called():
    plain = of(Operation("y", "multiply", "h", "x"))
    table = of(Operation("y", "interpolate", "table", "x"), coefficients=(TABLE,))
    called = ("is_within(", "saturated(", "interpolated(", "fabsf(")
    for text, wanted in (
        (guards(plain), [True, False, False, False]),
        (guards(plain, math=True), [True, False, False, True]),
        (guards(LAWS["limits"]), [True, True, False, False]),
        (guards(plain, table), [True, False, True, False]),
    ):
        assert [name in text for name in called] == wanted


def test_operations_of_every_kind():
    """As C writes them; the table is part of the function, a root is that of single precision."""
    for kind, left, code in (
        ("add", "x", "in->x + in->x"),
        ("subtract", "x", "in->x - in->x"),
        ("product", "x", "in->x * in->x"),
        ("divide", "x", "in->x / in->x"),
        ("multiply", "h", "NRS_SOME_LAW_H * in->x"),
        ("shift", "h", "NRS_SOME_LAW_H + in->x"),
        ("rest", "h", "NRS_SOME_LAW_H - in->x"),
        ("invert", "h", "NRS_SOME_LAW_H / in->x"),
        ("root", "", "sqrtf(in->x)"),
        ("interpolate", "table", "interpolated(table_of, 2U, in->x)"),
    ):
        coefficients = (TABLE,) if left == "table" else (HALF,)
        text = body(of(Operation("y", kind, left, "x"), coefficients=coefficients))
        assert f"const float y = {code};" in text
    assert "0x1.0p+2F" in text


def test_a_result_that_is_checked_is_refused():
    made = of(Operation("y", "invert", "h", "x"), checks={"y": Fraction(8)})
    assert "is_within(y, 0x1.0p+3F)" in body(made)
