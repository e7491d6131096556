"""Conformance cases of a mode logic: states, signals, and the exact results of a step."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from typing import Any

import numpy as np

from nrs_design.controllers.step_logic import LONGEST, StepLogic

COUNT, SEED = 500, 2026
SPECIAL = (0x7FC00000, 0x7F800000, 0xFF800000, 0)


def logic_document(logic: StepLogic) -> dict[str, Any]:
    """Return columns and cases, signals as bits in hexadecimal, the rest as integers."""
    columns = ["before.mode", "before.held", *logic.signals, "after.mode", "after.held"]
    return {"start": logic.start, "columns": columns, "cases": [*_cases(logic)]}


def _cases(logic: StepLogic) -> Iterator[list[int | str]]:
    # The bits of this generator are fixed; what NumPy makes of them may change.
    bits = iter(np.random.PCG64(SEED).random_raw(COUNT * (2 + len(logic.signals))).tolist())
    near = {
        name: [float(b.threshold) for s in logic.switches for b in s.bounds if b.signal == name]
        for name in logic.signals
    }
    for _ in range(COUNT):
        mode = next(bits) % (len(logic.stays) + 1)
        stay = logic.stays[mode] if mode < len(logic.stays) else 0
        held = (0, max(stay - 1, 0), stay, stay + 1, LONGEST)[next(bits) % 5]
        signals = [_signal(next(bits), near[name]) for name in logic.signals]
        values = np.array(signals, np.uint32).view(np.float32).tolist()
        seen = dict(zip(logic.signals, values, strict=True))
        after = logic.step(mode, held, seen)
        yield [mode, held, *(f"{one:08x}" for one in signals), *after]


def _signal(bits: int, near: list[float]) -> int:
    """Return a signal as bits: a threshold or a number next to one, or what is no number."""
    kind, bits = bits % 16, bits // 16
    if kind < len(SPECIAL):
        return SPECIAL[kind]
    (threshold,) = struct.unpack(">I", struct.pack(">f", near[bits % len(near)]))
    # Far away, too: with another exponent or the other sign.
    return (int(threshold) + (-1, 0, 1)[kind % 3]) ^ (0, 0, 1 << 23, 1 << 31)[kind % 4]
