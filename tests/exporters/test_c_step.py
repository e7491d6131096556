"""A law in C: a line for each operation in its order, and guards that let nothing else through."""

from fractions import Fraction

from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.c_step import definitions, guards
from tests.exporters.programs import LAWS

NAMES = CNames("some-law")
X = Value("x", "x", "rad", Fraction(2), "an input")
HALF = Coefficient("h", "h", "1", (Fraction(1, 2),))


def body(law):
    return definitions(law, NAMES)


def of(operation):
    return StepLaw(("m",), (X,), (), (HALF,), (operation,), {"o": "y"}, {}, {"o": "rad"})


def test_helpers_are_there_where_they_are_called():
    plain = of(Operation("y", "multiply", "h", "x"))
    called = ("is_within(", "saturated(")
    for text, wanted in ((guards(plain), [True, False]), (guards(LAWS["limits"]), [True, True])):
        assert [name in text for name in called] == wanted


def test_operations_of_every_kind():
    """As C writes them."""
    for kind, left, code in (
        ("add", "x", "in->x + in->x"),
        ("subtract", "x", "in->x - in->x"),
        ("multiply", "h", "NRS_SOME_LAW_H * in->x"),
        ("saturate", "h", "saturated(in->x, NRS_SOME_LAW_H)"),
    ):
        assert f"const float y = {code};" in body(of(Operation("y", kind, left, "x")))
