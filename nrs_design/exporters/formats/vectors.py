"""Conformance vectors: states and inputs, and the exact results of a step of the law.

As JSON and as CSV, with a test in C and one for pytest. All numbers are bits of single precision in
hexadecimal. A part of the inputs is what no sensor should give: not a number, infinities, subnormal
and random bits, modes that there are not.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.replica import Single, step
from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.c_names import CNames, harmless
from nrs_design.exporters.export import Export
from nrs_design.exporters.logic_cases import logic_document
from nrs_design.exporters.program import program_of
from nrs_design.exporters.self_test import program_macro, self_test
from nrs_design.exporters.template import fill_template
from nrs_design.output import C_TEST, C_TEST_HEADER, VECTOR_TABLE, VECTOR_TEST, VECTORS

FORMAT = Format(
    "inputs and exact outputs that any implementation of the law must give, with tests",
    SAMPLED,
    {
        ".vectors.json": VECTORS,
        ".vectors.csv": VECTOR_TABLE,
        "_test.h": C_TEST_HEADER,
        "_test.c": C_TEST,
        "_test.py": VECTOR_TEST,
    },
    executable=True,
)

COUNT, SEED = 1000, 2026
SCHEMA = "nrs-design/vectors/1"
# Zeros, the smallest and the largest numbers, one, infinities, not a number (quiet and signalling).
SPECIAL = (0, 1, 0x007FFFFF, 0x00800000, 0x7F7FFFFF, 0x3F800000, 0x7F800000, 0x7FC00000, 0x7F800001)


@dataclass(frozen=True, slots=True)
class Vectors:
    """Cases as bits."""

    # Mode, inputs, states before, outputs, whether the step is valid, states after.
    columns: tuple[str, ...]
    rows: NDArray[np.uint32]  # Shape (n, columns)


def render(export: Export) -> dict[str, bytes]:
    """Return vectors and tests, by their endings."""
    program = program_of(export)
    law, names, lines = program.law, program.names, program.about
    vectors = make_vectors(law)
    return {
        ".vectors.json": vectors_text(law, vectors, lines).encode(),
        ".vectors.csv": csv_text(vectors, lines).encode(),
        **self_test(law, vectors.columns, vectors.rows, names, lines),
        "_test.py": pytest_text(names, lines).encode(),
    }


def make_vectors(law: StepLaw, count: int = COUNT) -> Vectors:
    """Draw inputs and states, always the same ones, and compute a step of each."""
    # The bits of this generator are fixed; what NumPy makes of them may change.
    draw = np.random.PCG64(SEED).random_raw
    wild = draw(count) % 4 == 0
    mode = (draw(count) % (len(law.modes) + wild).astype(np.uint64)).astype(np.uint32)
    given: dict[str, Single] = {}
    for value in law.values:
        scale = np.float32(min(float(value.limit), 1.0))
        given[value.name] = _draw(draw(count), draw(count), wild, scale)
    result = step(law, mode, given)
    parts: dict[str, NDArray[np.uint32]] = {"mode": mode}
    parts |= {v.name: _bits(given[v.name]) for v in law.inputs}
    parts |= {f"before.{v.name}": _bits(given[v.name]) for v in law.states}
    parts |= {name: _bits(values) for name, values in result.outputs.items()}
    parts["valid"] = result.valid.astype(np.uint32)
    parts |= {f"after.{v.name}": _bits(result.states[v.name]) for v in law.states}
    return Vectors(tuple(parts), np.stack(list(parts.values()), axis=1))


def _draw(
    bits: NDArray[np.uint64], kinds: NDArray[np.uint64], wild: NDArray[np.bool_], scale: np.float32
) -> Single:
    """Return numbers of many sizes up to a scale; a quarter of the wild ones are no such."""
    centered = (bits >> np.uint64(40)).astype(np.float32) - np.float32(2**23)
    smaller = np.ldexp(np.float32(1), -(kinds >> np.uint64(60)).astype(np.int32))
    plain = centered * np.float32(2.0**-23) * scale * smaller
    low = bits.astype(np.uint32)
    special = np.array(SPECIAL, np.uint32)[low % len(SPECIAL)] | (low & np.uint32(1 << 31))
    subnormal = low & np.uint32(0x807FFFFF)
    kind = np.where(wild, kinds % 12, 12)
    odd = np.select([kind == 0, kind == 1, kind == 2], [low, special, subnormal], _bits(plain))
    return odd.astype(np.uint32).view(np.float32)


def _bits(values: Single) -> NDArray[np.uint32]:
    return np.ascontiguousarray(values, np.float32).view(np.uint32)


def vectors_text(law: StepLaw, vectors: Vectors, about: tuple[str, ...]) -> str:
    """Return the JSON document."""
    head: dict[str, Any] = {
        "schema": SCHEMA,
        "about": list(about),
        "numbers": "mode and valid as integers, all others as bits of IEEE 754 single precision, "
        "big end first, in hexadecimal",
        "modes": list(law.modes),
        "inputs": [value.name for value in law.inputs],
        "states": [value.name for value in law.states],
        "outputs": list(law.outputs),
        "units": {value.name: value.unit for value in law.values} | dict(law.units),
        "columns": list(vectors.columns),
    }
    if law.logic is not None:
        head["logic"] = logic_document(law.logic)
    text = json.dumps(head, indent=2).removesuffix("\n}")
    rows = ",\n".join(f"    {json.dumps(row)}" for row in vector_rows(vectors))
    return f'{text},\n  "cases": [\n{rows}\n  ]\n}}\n'


def csv_text(vectors: Vectors, about: tuple[str, ...]) -> str:
    """Return the same cases as CSV, below comments that begin with ``#``."""
    lines = [
        VECTOR_TABLE.decode().rstrip(),
        *(f"# {line}" for line in about),
        ",".join(vectors.columns),
    ]
    return "\n".join([*lines, *(",".join(map(str, row)) for row in vector_rows(vectors))]) + "\n"


def vector_rows(vectors: Vectors) -> Iterator[list[int | str]]:
    """Yield the cases: mode and valid as integers, all others as bits in hexadecimal."""
    whole = [name in ("mode", "valid") for name in vectors.columns]
    for row in vectors.rows.tolist():
        yield [n if plain else f"{n:08x}" for n, plain in zip(row, whole, strict=True)]


def pytest_text(names: CNames, about: tuple[str, ...]) -> str:
    """Return a test for pytest: of the exported C, and of any implementation in Python."""
    about_lines = "\n".join(f"# {harmless(line)}" for line in about)
    return fill_template(
        "test.py.j2", spec=names.spec, program=program_macro(names), about=about_lines
    )
