"""The self-test in C: a function that holds every case against the law where it runs.

It needs no input or output: a controller can run it on its own processor before it starts.
A program around it, for a computer with a terminal, is compiled where a macro asks for it: many
laws go into one program, and only one of them has a ``main``.

A case is states and inputs, and the exact results of a step, as bits of single precision. A part of
the inputs is what no sensor should give: not a number, infinities, subnormal and random bits, modes
that there are not.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.replica import Single, step
from nrs_design.controllers.step_logic import LONGEST, StepLogic
from nrs_design.exporters.text import CNames, block_comment, fill_template
from nrs_design.output import C_TEST, C_TEST_HEADER

COUNT, LOGIC_COUNT, SEED = 1000, 500, 2026
# Zeros, the smallest and the largest numbers, one, infinities, not a number (quiet and signalling).
SPECIAL = (0, 1, 0x007FFFFF, 0x00800000, 0x7F7FFFFF, 0x3F800000, 0x7F800000, 0x7FC00000, 0x7F800001)
LOGIC_SPECIAL = (0x7FC00000, 0x7F800000, 0xFF800000, 0)


@dataclass(frozen=True, slots=True)
class StepCases:
    """StepCases of a law as bits."""

    # Mode, inputs, states before, outputs, whether the step is valid, states after.
    columns: tuple[str, ...]
    rows: NDArray[np.uint32]  # Shape (n, columns)


def self_test(
    law: StepLaw, cases: StepCases, names: CNames, description: tuple[str, ...]
) -> dict[str, bytes]:
    """Return header and source of the self-test, by their endings."""
    logic = [] if law.logic is None else [*logic_cases(law.logic)]
    rows, count = cases.rows, len(cases.rows) + len(logic)
    values = {
        "names": names,
        "law": law,
        "column": {name: i for i, name in enumerate(cases.columns)},
        "rows": [[f"0x{number:x}U" for number in row] for row in rows.tolist()],
        "program": program_macro(names),
        "passed": f"{names.spec}: all {count} cases are the same",
        "logic_rows": [[_constant(number) for number in row] for row in logic],
    }
    size = rows.nbytes + 4 * sum(map(len, logic))
    words = _words(count, size, names, " of the law and of its mode logic" if logic else "")
    heads = {
        "h": block_comment((*description, *words), C_TEST_HEADER),
        "c": block_comment((*description, f"More is in {names.spec}_test.h."), C_TEST),
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


def _words(count: int, size: int, names: CNames, subject: str) -> tuple[str, ...]:
    return (
        "",
        f"{names.lower}_self_test computes {count} steps{subject} from inputs and states stored "
        f"with it ({size} bytes of constants), and compares every bit. It changes no state of the "
        "caller.",
        f"Compiled with -D{program_macro(names)}, {names.spec}_test.c is a program that runs it.",
        "It tells that this processor computes the law with these numbers. It tests no input or "
        "output, no clock, and nothing that runs beside it.",
    )


def draw_cases(law: StepLaw, count: int = COUNT) -> StepCases:
    """Draw inputs and states, always the same ones, and compute a step of each."""
    # NumPy promises the raw bits of this generator only, not its distributions.
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
    return StepCases(tuple(parts), np.stack(list(parts.values()), axis=1))


def _draw(
    bits: NDArray[np.uint64], kinds: NDArray[np.uint64], wild: NDArray[np.bool_], scale: np.float32
) -> Single:
    """Return numbers of many sizes up to a scale; a quarter of the wild ones are no such."""
    centered = (bits >> np.uint64(40)).astype(np.float32) - np.float32(2**23)
    smaller = np.ldexp(np.float32(1), -(kinds >> np.uint64(60)).astype(np.int32))
    ordinary = centered * np.float32(2.0**-23) * scale * smaller
    low = bits.astype(np.uint32)
    special = np.array(SPECIAL, np.uint32)[low % len(SPECIAL)] | (low & np.uint32(1 << 31))
    subnormal = low & np.uint32(0x807FFFFF)
    kind = np.where(wild, kinds % 12, 12)
    odd = np.select([kind == 0, kind == 1, kind == 2], [low, special, subnormal], _bits(ordinary))
    return odd.astype(np.uint32).view(np.float32)


def _bits(values: Single) -> NDArray[np.uint32]:
    return np.ascontiguousarray(values, np.float32).view(np.uint32)


def logic_cases(logic: StepLogic) -> Iterator[list[int | str]]:
    """Yield mode and held before, signals as bits in hexadecimal, mode and held after."""
    bits = iter(np.random.PCG64(SEED).random_raw(LOGIC_COUNT * (2 + len(logic.signals))).tolist())
    thresholds = {
        name: [float(b.threshold) for s in logic.switches for b in s.bounds if b.signal == name]
        for name in logic.signals
    }
    for _ in range(LOGIC_COUNT):
        mode = next(bits) % (len(logic.hold_samples) + 1)
        stay = logic.hold_samples[mode] if mode < len(logic.hold_samples) else 0
        dwell = (0, max(stay - 1, 0), stay, stay + 1, LONGEST)[next(bits) % 5]
        signals = [_signal(next(bits), thresholds[name]) for name in logic.signals]
        values = np.array(signals, np.uint32).view(np.float32).tolist()
        after = logic.step(mode, dwell, dict(zip(logic.signals, values, strict=True)))
        yield [mode, dwell, *(f"{one:08x}" for one in signals), *after]


def _signal(bits: int, thresholds: list[float]) -> int:
    """Return a signal as bits: a threshold or a number next to one, or what is no number."""
    kind, bits = bits % 16, bits // 16
    if kind < len(LOGIC_SPECIAL):
        return LOGIC_SPECIAL[kind]
    (threshold,) = struct.unpack(">I", struct.pack(">f", thresholds[bits % len(thresholds)]))
    # Far away, too: with another exponent or the other sign.
    return (int(threshold) + (-1, 0, 1)[kind % 3]) ^ (0, 0, 1 << 23, 1 << 31)[kind % 4]
