"""The self-test in C: a function that holds every case against the law where it runs.

It needs no input or output: a controller can run it on its own processor before it starts.
A program around it, for a computer with a terminal, is compiled where a macro asks for it: many
laws go into one program, and only one of them has a ``main``.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.operations import StepLaw
from nrs_design.exporters.c_names import CNames, block_comment
from nrs_design.output import C_TEST, C_TEST_HEADER


def self_test(
    law: StepLaw,
    columns: Sequence[str],
    rows: NDArray[np.uint32],
    names: CNames,
    about: tuple[str, ...],
) -> dict[str, bytes]:
    """Return header and source of the self-test, by their endings.

    Parameters
    ----------
    law : StepLaw
        The law.
    columns : sequence of str
        What the cases hold, as vectors name it.
    rows : ndarray of uint32
        The cases.
    names : CNames
        Of its spec.
    about : tuple of str
        What every exported file says of itself.
    """
    header = _header(len(rows), rows.nbytes, names, about)
    return {
        "_test.h": header.encode(),
        "_test.c": _source(law, columns, rows, names, about).encode(),
    }


def program_macro(names: CNames) -> str:
    """Return the macro that asks for the program around a self-test."""
    return f"{names.upper}_TEST_PROGRAM"


def _header(count: int, size: int, names: CNames, about: tuple[str, ...]) -> str:
    guard = f"{names.upper}_TEST_H"
    return f"""\
{block_comment((*about, *_words(count, size, names)), C_TEST_HEADER)}
#ifndef {guard}
#define {guard}

#include <stdint.h>

#define {names.upper}_TEST_CASES {count}U

/* The index of the first case that differs, or -1. */
int32_t {names.lower}_self_test(void);

#endif
"""


def _words(count: int, size: int, names: CNames) -> tuple[str, ...]:
    return (
        "",
        f"{names.lower}_self_test computes {count} steps from inputs and states that are stored "
        f"with it ({size} bytes of constants), and compares every bit. It changes no state of the "
        "caller.",
        f"Compiled with -D{program_macro(names)}, {names.spec}_test.c is a program that runs it.",
        "It tells that this processor computes the law with these numbers. It tests no input or "
        "output, no clock, and nothing that runs beside it.",
    )


_BITS = """\
static float from_bits(uint32_t bits)
{
    float value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}

static uint32_t to_bits(float value)
{
    uint32_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    return bits;
}
"""


def _source(
    law: StepLaw,
    columns: Sequence[str],
    rows: NDArray[np.uint32],
    names: CNames,
    about: tuple[str, ...],
) -> str:
    table = ",\n".join("    {" + ", ".join(f"0x{n:x}U" for n in row) + "}" for row in rows.tolist())
    return f"""\
{block_comment((*about, f"More is in {names.spec}_test.h."), C_TEST)}
#include "{names.spec}.h"
#include "{names.spec}_test.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

static const uint32_t cases[{names.upper}_TEST_CASES][{len(columns)}] = {{
{table}
}};

{_BITS}
{_case(law, columns, names)}
{_program(len(rows), names)}"""


def _case(law: StepLaw, columns: Sequence[str], names: CNames) -> str:
    """Write the function that computes a case and compares it."""
    own, column = names.lower, {name: i for i, name in enumerate(columns)}
    reads = [f"in.{v.name} = from_bits(row[{column[v.name]}]);" for v in law.inputs]
    reads += [f"state.{v.name} = from_bits(row[{column[f'before.{v.name}']}]);" for v in law.states]
    checks = [f"(to_bits(out.{name}) == row[{column[name]}])" for name in law.outputs]
    checks += [f"(to_bits(state.{v.name}) == row[{column[f'after.{v.name}']}])" for v in law.states]
    starts = [
        f"(to_bits(state.{v.name}) == to_bits({'in.angle' if v.starts_at_angle else '0.0F'}))"
        for v in law.states
    ]
    return f"""\
static bool passes(const uint32_t *row)
{{
    {own}_input_t in;
    {own}_state_t state;
    {own}_output_t out;
    bool same;
    in.mode = row[0];
    {_lines(reads)}
    {own}_step(&in, &state, &out);
    same = ((out.valid ? 1U : 0U) == row[{column["valid"]}]) &&
        {_all(checks)};
    {own}_init(&state, in.angle);
    return same &&
        {_all(starts)};
}}
"""


def _program(count: int, names: CNames) -> str:
    """Write the function over all cases, and the program around it."""
    own = names.lower
    return f"""\
int32_t {own}_self_test(void)
{{
    int32_t first = -1;
    uint32_t k;
    for (k = 0U; (k < {names.upper}_TEST_CASES) && (first < 0); k++) {{
        if (!passes(cases[k])) {{
            first = (int32_t)k;
        }}
    }}
    return first;
}}

#if defined({program_macro(names)})
#include <stdio.h>

int main(void)
{{
    const int32_t first = {own}_self_test();
    if (first >= 0) {{
        (void)printf("case %ld differs\\n", (long)first);
        return 1;
    }}
    (void)printf("{names.spec}: all {count} cases are the same\\n");
    return 0;
}}
#endif
"""


def _lines(statements: list[str]) -> str:
    return "\n    ".join(statements)


def _all(conditions: list[str]) -> str:
    return " &&\n        ".join(conditions)
