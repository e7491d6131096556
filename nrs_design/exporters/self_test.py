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
from nrs_design.exporters.logic_cases import logic_document
from nrs_design.exporters.template import fill_template
from nrs_design.output import C_TEST, C_TEST_HEADER


def self_test(
    law: StepLaw,
    columns: Sequence[str],
    rows: NDArray[np.uint32],
    names: CNames,
    about: tuple[str, ...],
) -> dict[str, bytes]:
    """Return header and source of the self-test, by their endings."""
    logic = [] if law.logic is None else logic_document(law.logic)["cases"]
    count = len(rows) + len(logic)
    values = {
        "names": names,
        "law": law,
        "column": {name: i for i, name in enumerate(columns)},
        "rows": [[f"0x{number:x}U" for number in row] for row in rows.tolist()],
        "program": program_macro(names),
        "passed": f"{names.spec}: all {count} cases are the same",
        "logic_rows": [[_constant(number) for number in row] for row in logic],
    }
    size = rows.nbytes + 4 * sum(map(len, logic))
    words = _words(count, size, names, " of the law and of its mode logic" if logic else "")
    heads = {
        "h": block_comment((*about, *words), C_TEST_HEADER),
        "c": block_comment((*about, f"More is in {names.spec}_test.h."), C_TEST),
    }
    return {
        f"_test.{end}": fill_template(f"test.{end}.j2", comment=head, **values).encode()
        for end, head in heads.items()
    }


def _constant(number: int | str) -> str:
    """Return an integer, or bits in hexadecimal, as C has it."""
    return f"{number}U" if isinstance(number, int) else f"0x{number}U"


def program_macro(names: CNames) -> str:
    """Return the macro that asks for the program around a self-test."""
    return f"{names.upper}_TEST_PROGRAM"


def _words(count: int, size: int, names: CNames, of: str) -> tuple[str, ...]:
    return (
        "",
        f"{names.lower}_self_test computes {count} steps{of} from inputs and states stored "
        f"with it ({size} bytes of constants), and compares every bit. It changes no state of the "
        "caller.",
        f"Compiled with -D{program_macro(names)}, {names.spec}_test.c is a program that runs it.",
        "It tells that this processor computes the law with these numbers. It tests no input or "
        "output, no clock, and nothing that runs beside it.",
    )
