"""A law in C99: what its header declares, and `init` and `step` of its source.

One line for each operation, one rounding for each line. What is beyond the list of operations is
guards: they refuse wrong input, and no proof covers them.
"""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.controllers.operations import Operation, StepLaw
from nrs_design.controllers.parts import BEYOND
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.template import fill_template

SIGN = {"add": "+", "subtract": "-", "multiply": "*"}
FLAGS = (
    "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Werror -ffp-contract=off"
)


def guards(law: StepLaw) -> str:
    """Return what refuses other arithmetic, and the functions that the step of a law calls."""
    return fill_template("guards.c.j2", kinds={operation.kind for operation in law.operations})


def declarations(law: StepLaw, names: CNames) -> str:
    """Return numbers, types and functions of a law, as its header has them."""
    origins = {
        value.name: "not " * (value.limit in (BEYOND, 2 * BEYOND)) + "from the spec"
        for value in law.values
    }
    return fill_template("declarations.h.j2", law=law, names=names, origins=origins)


def definitions(law: StepLaw, names: CNames) -> str:
    """Return the functions of a law, as its source has them."""
    results = {f"out->{name}": value for name, value in law.outputs.items()}
    results |= {f"state->{name}": value for name, value in law.following.items()}
    within = [f"is_within({_operand(law, names, v.name)}, {names.limit(v)})" for v in law.values]
    return fill_template(
        "definitions.c.j2",
        law=law,
        names=names,
        tables=[*_tables(law, names)],
        guards=[f"(in->mode < {names.modes})", *within],
        operations=[(one.name, _expression(law, names, one)) for one in law.operations],
        results=[(place, _operand(law, names, value)) for place, value in results.items()],
    )


def _tables(law: StepLaw, names: CNames) -> Iterator[tuple[str, list[str]]]:
    """Yield name and entries of each coefficient that every mode has one of."""
    for c in law.coefficients:
        if c.by_mode:
            yield c.name, [names.coefficient(c, mode) for mode in law.modes]


def _expression(law: StepLaw, names: CNames, operation: Operation) -> str:
    left, right = (_operand(law, names, name) for name in (operation.left, operation.right))
    if operation.kind == "saturate":
        return f"saturated({right}, {left})"
    return f"{left} {SIGN[operation.kind]} {right}"


def _operand(law: StepLaw, names: CNames, name: str) -> str:
    if name in law.coefficient:
        coefficient = law.coefficient[name]
        return f"{name}_of[in->mode]" if coefficient.by_mode else names.coefficient(coefficient)
    if any(value.name == name for value in law.inputs):
        return f"in->{name}"
    return f"state->{name}" if any(value.name == name for value in law.states) else name
