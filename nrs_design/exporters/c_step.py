"""A law in C99: what its header declares, and `init` and `step` of its source.

One line for each operation, one rounding for each line. What is beyond the list of operations is
guards: they refuse wrong input, and no proof covers them.
"""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.controllers.operations import Operation, StepLaw
from nrs_design.controllers.parts import BEYOND
from nrs_design.exporters.c_names import CNames, literal
from nrs_design.exporters.template import fill_template

SIGN = {
    "add": "+",
    "subtract": "-",
    "multiply": "*",
    "shift": "+",
    "rest": "-",
    "product": "*",
    "divide": "/",
    "invert": "/",
}
FLAGS = (
    "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Werror -ffp-contract=off"
)


def guards(*laws: StepLaw, about: str = "the proof is about", math: bool = False) -> str:
    """Return what refuses other arithmetic, and the functions that the steps of laws call.

    `about` begins the message that IEEE 754 arithmetic is needed; `math`: the source includes
    math.h.
    """
    kinds = {operation.kind for law in laws for operation in law.operations}
    return fill_template("guards.c.j2", kinds=kinds, about=about, math=math)


def declarations(law: StepLaw, names: CNames) -> str:
    """Return numbers, types and functions of a law, as its header has them."""
    known = "from the spec" if law.modes else "where the formulas hold"
    origins = {
        value.name: "not from the spec" if value.limit in (BEYOND, 2 * BEYOND) else known
        for value in law.guarded
    }
    return fill_template("declarations.h.j2", law=law, names=names, origins=origins)


def definitions(law: StepLaw, names: CNames) -> str:
    """Return the functions of a law, as its source has them."""
    results = {f"out->{name}": value for name, value in law.outputs.items()}
    results |= {f"state->{name}": value for name, value in law.following.items()}
    within = [f"is_within({_operand(law, names, v.name)}, {names.limit(v)})" for v in law.guarded]
    return fill_template(
        "definitions.c.j2",
        law=law,
        names=names,
        tables=[*_tables(law, names)],
        guards=[*([f"(in->mode < {names.modes})"] if law.modes else []), *within],
        operations=[(one.name, _expression(law, names, one)) for one in law.operations],
        checks=[f"is_within({name}, {literal(most)})" for name, most in law.checks.items()],
        results=[(place, _operand(law, names, value)) for place, value in results.items()],
    )


def _tables(law: StepLaw, names: CNames) -> Iterator[tuple[str, str, list[str]]]:
    """Yield name, size and entries of each table: of coefficients by mode, then of others."""
    for c in law.coefficients:
        if c.by_mode:
            yield c.name, names.modes, [names.coefficient(c, mode) for mode in law.modes]
    for c in law.coefficients:
        if c.table:
            yield c.name, f"{len(c.values)}U", [literal(value) for value in c.values]


def _expression(law: StepLaw, names: CNames, operation: Operation) -> str:
    right = _operand(law, names, operation.right)
    if operation.kind == "root":
        return f"sqrtf({right})"
    if operation.kind == "interpolate":
        last = len(law.coefficient[operation.left].values) - 1
        return f"interpolated({operation.left}_of, {last}U, {right})"
    left = _operand(law, names, operation.left)
    if operation.kind == "saturate":
        return f"saturated({right}, {left})"
    return f"{left} {SIGN[operation.kind]} {right}"


def _operand(law: StepLaw, names: CNames, name: str) -> str:
    if name in law.coefficient:
        coefficient = law.coefficient[name]
        if coefficient.inline:
            return literal(coefficient.values[0])
        return f"{name}_of[in->mode]" if coefficient.by_mode else names.coefficient(coefficient)
    if any(value.name == name for value in law.inputs):
        return f"in->{name}"
    return f"state->{name}" if any(value.name == name for value in law.states) else name
