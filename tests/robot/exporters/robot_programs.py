"""Programs that run cases of a robot's laws and compare every bit, and cases for them."""

from nrs_design.exporters.formats.vectors import make_vectors
from nrs_design.robot.exporters.c import names_of

_MAIN = """\
#include "{spec}.h"
#include <stdint.h>
#include <stdio.h>
#include <string.h>

static float from_bits(uint32_t bits)
{{
    float value;
    (void)memcpy(&value, &bits, sizeof value);
    return value;
}}

static uint32_t to_bits(float value)
{{
    uint32_t bits;
    (void)memcpy(&bits, &value, sizeof bits);
    return bits;
}}

{tables}
int main(void)
{{
    unsigned long wrong = 0UL;
    unsigned long k;
{loops}
    (void)printf("%lu cases differ\\n", wrong);
    return 0;
}}
"""


def program(spec, laws, cases):
    """Return the C of a program that runs all cases of all laws.

    Parameters
    ----------
    spec : str
        Name of the robot.
    laws : mapping of str to StepLaw
        By the end of their names.
    cases : mapping of str to Vectors
        As `make_vectors` or `poses` give them.
    """
    tables = "".join(_table(name, cases[name].rows) for name in laws)
    loops = "".join(_loop(spec, name, law, cases[name]) for name, law in laws.items())
    return _MAIN.format(spec=spec, tables=tables, loops=loops)


def _table(name, rows):
    body = ",\n".join("{" + ", ".join(f"0x{n:x}U" for n in row) + "}" for row in rows.tolist())
    return f"static const uint32_t {name}_cases[{len(rows)}][{rows.shape[1]}] = {{\n{body}\n}};\n"


def _loop(spec, name, law, cases):
    own, column = names_of(spec, name).lower, {n: i for i, n in enumerate(cases.columns)}
    reads = [f"in.{v.name} = from_bits(row[{column[v.name]}]);" for v in law.inputs]
    reads += [f"state.{v.name} = from_bits(row[{column[f'before.{v.name}']}]);" for v in law.states]
    checks = [f"(to_bits(out.{n}) == row[{column[n]}])" for n in law.outputs]
    checks += [f"(to_bits(state.{v.name}) == row[{column[f'after.{v.name}']}])" for v in law.states]
    state = f"{own}_state_t state;" if law.states else ""
    given = "&in, &state, &out" if law.states else "&in, &out"
    return f"""
    for (k = 0UL; k < {len(cases.rows)}UL; k++) {{
        const uint32_t *row = {name}_cases[k];
        {own}_input_t in;
        {own}_output_t out;
        {state}
        {" ".join(reads)}
        {own}_step({given});
        if (!(((out.valid ? 1U : 0U) == row[{column["valid"]}]) && {" && ".join(checks)})) {{
            wrong++;
        }}
    }}
"""


def wild(laws, count):
    """Return cases with what no sensor should give among them."""
    return {name: make_vectors(law, count) for name, law in laws.items()}
