"""A law in C99: what its header declares, and `init` and `step` of its source.

One line for each operation, one rounding for each line. What is beyond the list of operations is
guards: they refuse wrong input, and no proof covers them.
"""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.operations import Operation, StepLaw, Value
from nrs_design.controllers.parts import BEYOND
from nrs_design.exporters.c_names import CNames, literal

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
# A compiler that is told that all numbers are finite may leave guards out.
FINITE = """\
#if defined(__FINITE_MATH_ONLY__) && (__FINITE_MATH_ONLY__ != 0)
#error "comparisons with what is not a number have to be false: compile without -ffinite-math-only"
#endif
"""
REFUSALS = f"""\
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__)
#error "the proof is about IEEE 754 arithmetic: compile without -ffast-math, and parts of it"
#endif
{FINITE}\
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
WITHIN = """\
/* Of a NaN, every comparison is false. */
static bool is_within(float value, float limit)
{
    return (value >= -limit) && (value <= limit);
}
"""
# The same in half of the instructions, where there is math.h anyway.
MAGNITUDE_WITHIN = """\
/* Of a NaN, every comparison is false. */
static bool is_within(float value, float limit)
{
    return fabsf(value) <= limit;
}
"""
SATURATED = """\
static float saturated(float value, float limit)
{
    return (value > limit) ? limit : ((value < -limit) ? -limit : value);
}
"""
INTERPOLATED = """\
/* Between two entries of a table, its ends kept; a NaN is the first entry. */
static float interpolated(const float table[], uint32_t last, float position)
{
    const float top = (float)last;
    const float kept = (position > 0.0F) ? ((position < top) ? position : top) : 0.0F;
    const uint32_t whole = (uint32_t)kept;
    const uint32_t index = (whole < last) ? whole : (last - 1U);
    const float share = kept - (float)index;
    const float change = table[index + 1U] - table[index];
    return table[index] + (share * change);
}
"""


def helpers(*laws: StepLaw, within: str = WITHIN) -> list[str]:
    """Return the functions that the steps of some laws call.

    Parameters
    ----------
    *laws : StepLaw
        All laws of a source.
    within : str
        The function that tells whether a number is within a limit.
    """
    kinds = {operation.kind for law in laws for operation in law.operations}
    used = {"saturate": SATURATED, "interpolate": INTERPOLATED}
    return [within, *(text for kind, text in used.items() if kind in kinds)]


def declarations(law: StepLaw, names: CNames) -> list[str]:
    """Return numbers, types and functions of a law, as its header has them.

    Parameters
    ----------
    law : StepLaw
        Its operations.
    names : CNames
        Of the spec.
    """
    first = ["uint32_t mode;"] if law.modes else []
    state = [_struct("state", f"{names.lower}_state_t", [], law.states)] if law.states else []
    return [
        "".join(_macros(law, names)),
        _struct("input", f"{names.lower}_input_t", first, law.inputs),
        *state,
        _output(law, names),
        "\n".join(f"{prototype};" for prototype in _prototypes(law, names)) + "\n",
    ]


def definitions(law: StepLaw, names: CNames) -> list[str]:
    """Return the functions of a law, as its source has them.

    Parameters
    ----------
    law : StepLaw
        Its operations.
    names : CNames
        Of the spec.
    """
    *init, step = _prototypes(law, names)
    return [
        *(f"{prototype}\n{{\n{''.join(_start(law))}}}\n" for prototype in init),
        f"{step}\n{{\n{''.join(_step(law, names))}}}\n",
    ]


def _macros(law: StepLaw, names: CNames) -> Iterator[str]:
    if law.modes:
        yield "/* Modes. */\n"
        yield f"#define {names.modes} {len(law.modes)}U\n"
        yield from (f"#define {names.mode(mode)} {k}U\n" for k, mode in enumerate(law.modes))
        yield "\n"
    coefficients = names.coefficients(law)
    if coefficients:
        yield "/* The numbers of the law, exactly. */\n"
    for macro, (coefficient, value) in coefficients.items():
        unit = "without unit" if coefficient.unit == "1" else coefficient.unit
        yield f"#define {macro} {literal(value)} /* {exact_decimal(value)} {unit} */\n"
    yield "\n" if coefficients else ""
    yield "/* Beyond these, an input or a state is refused. */\n"
    for given in law.guarded:
        origin = "from the spec" if law.modes else "where the formulas hold"
        note = "not from the spec" if given.limit in (BEYOND, 2 * BEYOND) else origin
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


def _prototypes(law: StepLaw, names: CNames) -> list[str]:
    """Return the heads of `init`, where there is a state, and of `step`."""
    own = names.lower
    given = [f"const {own}_input_t *in", f"{own}_output_t *out"]
    step = f"void {own}_step(\n    "
    if not law.states:
        return [step + ",\n    ".join(given) + ")"]
    given.insert(1, f"{own}_state_t *state")
    angle = ", float angle" if law.modes else ""
    return [
        f"void {own}_init({own}_state_t *state{angle})",
        step + ",\n    ".join(given) + ")",
    ]


def _start(law: StepLaw) -> Iterator[str]:
    """Yield the start: at rest where the joint is."""
    if law.modes and not any(state.starts_at_angle for state in law.states):
        yield "    (void)angle;\n"
    for state in law.states:
        begins = "angle" if state.starts_at_angle else "0.0F"
        yield f"    state->{state.name} = {begins};\n"


def _step(law: StepLaw, names: CNames) -> Iterator[str]:
    yield from _tables(law, names)
    checks = [f"(in->mode < {names.modes})"] if law.modes else []
    checks += [f"is_within({_operand(law, names, v.name)}, {names.limit(v)})" for v in law.guarded]
    yield f"    out->valid = {_all(checks)};\n    if (out->valid) {{\n"
    for operation in law.operations:
        yield f"        const float {operation.name} = {_expression(law, names, operation)};\n"
    yield "\n"
    if law.checks:
        within = [f"is_within({name}, {literal(most)})" for name, most in law.checks.items()]
        yield f"        out->valid = {_all(within, 3)};\n        if (out->valid) {{\n"
    space = "            " if law.checks else "        "
    for name, value in law.outputs.items():
        yield f"{space}out->{name} = {_operand(law, names, value)};\n"
    for name, value in law.following.items():
        yield f"{space}state->{name} = {_operand(law, names, value)};\n"
    yield "        }\n    }\n    if (!out->valid) {\n" if law.checks else "    } else {\n"
    yield from (f"        out->{name} = 0.0F;\n" for name in law.outputs)
    yield "    }\n"


def _tables(law: StepLaw, names: CNames) -> Iterator[str]:
    by_mode = [c for c in law.coefficients if c.by_mode]
    for c in by_mode:
        each = [names.coefficient(c, mode) for mode in law.modes]
        yield _table(c.name, names.modes, each)
    tables = [c for c in law.coefficients if c.table]
    for c in tables:
        yield _table(c.name, f"{len(c.values)}U", [literal(value) for value in c.values])
    yield "\n" if by_mode or tables else ""


def _table(name: str, size: str, entries: list[str]) -> str:
    each = "".join(f"        {entry},\n" for entry in entries)
    return f"    static const float {name}_of[{size}] = {{\n{each}    }};\n"


def _all(conditions: list[str], indent: int = 2) -> str:
    return (" &&\n" + 4 * indent * " ").join(conditions)


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
