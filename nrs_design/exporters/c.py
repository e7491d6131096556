"""The law in C99: a header with numbers and types, and a source with `init` and `step`.

No heap, no recursion, no function of libm, one rounding for each operation. What is beyond the list
of operations is guards: they refuse wrong input, and no proof covers them.
"""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.operations import Operation, StepLaw, Value
from nrs_design.controllers.step_parts import BEYOND
from nrs_design.exporters.c_names import CNames, comment, literal
from nrs_design.exporters.export import Export
from nrs_design.exporters.header import header_lines
from nrs_design.exporters.record import ExportRecord
from nrs_design.exporters.shipped import law_of
from nrs_design.output import C_HEADER, C_SOURCE

SIGN = {"add": "+", "subtract": "-", "multiply": "*"}
FLAGS = (
    "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Werror -ffp-contract=off"
)


def render(export: Export) -> dict[str, bytes]:
    """Return header and source, by their endings.

    Parameters
    ----------
    export : Export
        With a record, proved or not.

    Raises
    ------
    DesignError
        If there is no program of a controller yet.
    """
    record, law = export.shipped(), law_of(export)
    names = CNames(record.spec.name)
    return {
        ".h": header_text(record, law, names).encode(),
        ".c": source_text(record, law, names).encode(),
    }


def header_text(record: ExportRecord, law: StepLaw, names: CNames) -> str:
    """Return the header.

    Parameters
    ----------
    record : ExportRecord
        What the law is, and what is proved of it.
    law : StepLaw
        Its operations.
    names : CNames
        Of this spec.
    """
    guard = f"{names.upper}_H"
    lines = [
        comment(_header_lines(record, law, names), C_HEADER),
        f"#ifndef {guard}\n#define {guard}\n",
        "#include <stdbool.h>\n#include <stdint.h>\n",
        "".join(_macros(law, names)),
        _struct("input", f"{names.lower}_input_t", ["uint32_t mode;"], law.inputs),
        _struct("state", f"{names.lower}_state_t", [], law.states),
        _output(law, names),
        "\n".join(_prototypes(names, ";")) + "\n",
        "#endif\n",
    ]
    return "\n".join(lines)


def source_text(record: ExportRecord, law: StepLaw, names: CNames) -> str:
    """Return the source.

    Parameters
    ----------
    record : ExportRecord
        What the law is, and what is proved of it.
    law : StepLaw
        Its operations.
    names : CNames
        Of this spec.
    """
    init, step = _prototypes(names)
    lines = [
        comment((*header_lines(record), f"More is in {record.spec.name}.h."), C_SOURCE),
        f'#include "{record.spec.name}.h"\n\n#include <float.h>\n',
        _REFUSALS,
        _WITHIN,
        *([_SATURATED] if any(o.kind == "saturate" for o in law.operations) else []),
        f"{init}\n{{\n{''.join(_start(law))}}}\n",
        f"{step}\n{{\n{''.join(_step(law, names))}}}\n",
    ]
    return "\n".join(lines)


_REFUSALS = """\
#if defined(__FAST_MATH__)
#error "the proof is about IEEE 754 arithmetic: compile without -ffast-math"
#endif
#if (FLT_RADIX != 2) || (FLT_MANT_DIG != 24) || (FLT_MAX_EXP != 128)
#error "float has to be IEEE 754 single precision"
#endif
#if !defined(FLT_EVAL_METHOD) || (FLT_EVAL_METHOD != 0)
#error "every operation has to round to single precision: FLT_EVAL_METHOD has to be 0"
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#endif
"""
_WITHIN = """\
/* Of a NaN, every comparison is false. */
static bool is_within(float value, float limit)
{
    return (value >= -limit) && (value <= limit);
}
"""
_SATURATED = """\
static float saturated(float value, float limit)
{
    return (value > limit) ? limit : ((value < -limit) ? -limit : value);
}
"""


def _header_lines(record: ExportRecord, law: StepLaw, names: CNames) -> Iterator[str]:
    yield from header_lines(record)
    yield ""
    yield f"Call {names.lower}_init once, then {names.lower}_step at every sample. Compile with"
    yield FLAGS
    yield "and keep rounding to nearest, and subnormal numbers as they are."
    yield ""
    yield (
        "Guards, outside the proof: a step is not valid where the mode does not exist, or an input "
        "or a state is not a number or beyond its limit below. Then the command is 0 and the state "
        "stays as it was; what to do next is for the caller to say. A state that has left its "
        "limits is refused until init. Within the limits no operation overflows."
    )
    yield (
        "Saturation, outside the proof: of the command of the motor, at COMMAND_LIMIT below."
        if "command_limit" in law.coefficient
        else "The command of the motor does not saturate: the spec has no `limits: command`."
    )
    if "velocity_limit" in law.coefficient:
        yield "The velocity command saturates at VELOCITY_LIMIT before the law takes it."
    if record.proof is not None:
        yield ""
        yield "Taken for granted by the proof:"
        yield from (f"- {text}" for text in record.proof.assumptions)


def _macros(law: StepLaw, names: CNames) -> Iterator[str]:
    yield "/* Modes. */\n"
    yield f"#define {names.modes} {len(law.modes)}U\n"
    yield from (f"#define {names.mode(mode)} {k}U\n" for k, mode in enumerate(law.modes))
    yield "\n/* The numbers of the law, exactly. */\n"
    for macro, (coefficient, value) in names.coefficients(law).items():
        unit = "without unit" if coefficient.unit == "1" else coefficient.unit
        yield f"#define {macro} {literal(value)} /* {exact_decimal(value)} {unit} */\n"
    yield "\n/* Beyond these, an input or a state is refused. */\n"
    for given in law.values:
        note = "not from the spec" if given.limit in (BEYOND, 2 * BEYOND) else "from the spec"
        text = f"{literal(given.limit)} /* {exact_decimal(given.limit)} {given.unit}, {note} */"
        yield f"#define {names.limit(given)} {text}\n"


def _struct(tag: str, name: str, first: list[str], values: tuple[Value, ...]) -> str:
    fields = [*first, *(f"float {v.name}; /* {v.unit}: {v.meaning} */" for v in values)]
    return f"/* The {tag} of a step. */\ntypedef struct {{\n{_lines(fields)}}} {name};\n"


def _output(law: StepLaw, names: CNames) -> str:
    fields = [f"float {name}; /* {law.units[name]} */" for name in law.outputs]
    fields.append("bool valid; /* whether the step was computed */")
    name = f"{names.lower}_output_t"
    return f"/* The output of a step. */\ntypedef struct {{\n{_lines(fields)}}} {name};\n"


def _lines(fields: list[str]) -> str:
    return "".join(f"    {field}\n" for field in fields)


def _prototypes(names: CNames, end: str = "") -> tuple[str, str]:
    own = names.lower
    init = f"void {own}_init({own}_state_t *state, float angle){end}"
    given = [f"const {own}_input_t *in", f"{own}_state_t *state", f"{own}_output_t *out"]
    step = f"void {own}_step(\n    " + ",\n    ".join(given) + f"){end}"
    return init, step


def _start(law: StepLaw) -> Iterator[str]:
    """Yield the start: at rest where the joint is."""
    if not any(state.starts_at_angle for state in law.states):
        yield "    (void)angle;\n"
    for state in law.states:
        begins = "angle" if state.starts_at_angle else "0.0F"
        yield f"    state->{state.name} = {begins};\n"


def _step(law: StepLaw, names: CNames) -> Iterator[str]:
    for c in law.coefficients:
        if len(c.values) > 1:
            each = "".join(f"        {names.coefficient(c, mode)},\n" for mode in law.modes)
            yield f"    static const float {_table(c.name)}[{names.modes}] = {{\n{each}    }};\n"
    checks = [f"(in->mode < {names.modes})"]
    checks += [f"is_within(in->{v.name}, {names.limit(v)})" for v in law.inputs]
    checks += [f"is_within(state->{v.name}, {names.limit(v)})" for v in law.states]
    yield "\n" if any(len(c.values) > 1 for c in law.coefficients) else ""
    yield "    out->valid = " + " &&\n        ".join(checks) + ";\n    if (out->valid) {\n"
    for operation in law.operations:
        yield f"        const float {operation.name} = {_expression(law, names, operation)};\n"
    yield "\n"
    for name, value in law.outputs.items():
        yield f"        out->{name} = {_operand(law, names, value)};\n"
    for name, value in law.following.items():
        yield f"        state->{name} = {_operand(law, names, value)};\n"
    yield "    } else {\n"
    yield from (f"        out->{name} = 0.0F;\n" for name in law.outputs)
    yield "    }\n"


def _expression(law: StepLaw, names: CNames, operation: Operation) -> str:
    left, right = (_operand(law, names, name) for name in (operation.left, operation.right))
    if operation.kind != "saturate":
        return f"{left} {SIGN[operation.kind]} {right}"
    return f"saturated({right}, {left})"


def _operand(law: StepLaw, names: CNames, name: str) -> str:
    if name in law.coefficient:
        coefficient = law.coefficient[name]
        several = len(coefficient.values) > 1
        return f"{_table(name)}[in->mode]" if several else names.coefficient(coefficient)
    if any(value.name == name for value in law.inputs):
        return f"in->{name}"
    return f"state->{name}" if any(value.name == name for value in law.states) else name


def _table(name: str) -> str:
    return f"{name}_of"
