"""A law in C: a line for each operation in its order, and guards that let nothing else through."""

import re
from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.c_step import (
    SIGN,
    declarations,
    definitions,
    guards,
)
from tests.exporters.programs import LAWS

NAMES = CNames("some-law")
X = Value("x", "x", "rad", Fraction(2), "an input")
HALF = Coefficient("h", "h", "1", (Fraction(1, 2),))
TABLE = Coefficient("table", "t", "1", (Fraction(1), Fraction(2), Fraction(4)), table=True)


def body(law):
    return definitions(law, NAMES)


def of(*operations, coefficients=(HALF,), **others):
    """Return a law of one input whose last operation is its output."""
    last = operations[-1].name
    return StepLaw((), (X,), (), coefficients, operations, {"o": last}, {}, {"o": "rad"}, **others)


@pytest.mark.parametrize("shape", LAWS)
def test_there_is_a_line_for_each_operation_in_its_order(shape):
    law, text = LAWS[shape], body(LAWS[shape])
    lines = re.findall(r"const float (\w+) = ([^;{]*);", text)
    made = [(name, code) for name, code in lines if name in {o.name for o in law.operations}]
    assert [name for name, _ in made] == [o.name for o in law.operations]
    for operation, (_, code) in zip(law.operations, made, strict=True):
        assert code.count("saturated(") == (operation.kind == "saturate")
        signs = re.findall(r" [-+*/] ", code)
        assert signs == ([] if operation.kind == "saturate" else [f" {SIGN[operation.kind]} "])


@pytest.mark.parametrize("shape", LAWS)
def test_every_value_is_guarded_before_it_is_used(shape):
    """By its own limit, and the mode by how many there are."""
    law, text = LAWS[shape], body(LAWS[shape])
    step = text[text.index("_step(") :]
    guards, _, rest = step.partition("if (out->valid) {")
    assert f"in->mode < {NAMES.modes}" in guards
    for value in law.values:
        place = "in" if value in law.inputs else "state"
        assert len(re.findall(rf"{place}->{value.name}\b[^;]*{NAMES.limit(value)}\b", guards)) == 1
        assert f"{place}->{value.name}" in rest
    # What is not valid commands nothing and leaves the state.
    _, _, refused = rest.rpartition("} else {")
    assert all(f"out->{name} = 0.0F;" in refused for name in law.outputs)
    assert "state->" not in refused


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


def test_what_is_declared_names_units_and_meaning():
    law = LAWS["limits"]
    text = declarations(law, NAMES)
    for value in law.values:
        assert f"float {value.name}; /* {value.unit}: {value.meaning}" in text
    assert "float command; /* rpm" in text
    renamed = replace(law, units={"command": "V"})
    assert "float command; /* V" in declarations(renamed, NAMES)
