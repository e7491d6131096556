"""A step of a law in NumPy's single precision: bit for bit what the exported C computes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.operations import Coefficient, Kind, StepLaw

Single = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class StepResult:
    """What a step leaves, for a batch."""

    # outputs, states: by name; single precision, shape (n,).
    outputs: Mapping[str, Single]
    states: Mapping[str, Single]
    # Shape (n,). Where a step is not valid, outputs are zero and states stay as they were.
    valid: NDArray[np.bool_]


def step(law: StepLaw, mode: NDArray[np.uint32], given: Mapping[str, Single]) -> StepResult:
    """Compute one step for a batch, shape (n,), with one rounding for each operation.

    A mode that there is not makes the step invalid; a law without modes ignores it.
    """
    valid = mode < len(law.modes) if law.modes else np.ones(mode.shape, np.bool_)
    for value in law.guarded:
        valid = valid & _is_within(given[value.name], float(value.limit))
    known: dict[str, Single] = {
        value.name: np.where(valid, given[value.name], np.float32(0)) for value in law.values
    }
    known |= {c.name: _numbers(law, c, np.where(valid, mode, 0)) for c in law.coefficients}
    # What is no number or too large is found afterwards, by the checks.
    with np.errstate(all="ignore") if law.checks else nullcontext():
        known = law.read(known, _COMPUTED)
    for name, limit in law.checks.items():
        valid = valid & _is_within(known[name], float(limit))
    outputs = {
        name: np.where(valid, known[value], np.float32(0)) for name, value in law.outputs.items()
    }
    states = {
        name: np.where(valid, known[value], given[name]) for name, value in law.following.items()
    }
    return StepResult(outputs, states, valid)


def _is_within(values: Single, limit: float) -> NDArray[np.bool_]:
    most = np.float32(limit)
    return np.asarray((values >= -most) & (values <= most))


def _numbers(law: StepLaw, coefficient: Coefficient, mode: NDArray[np.uint32]) -> Single:
    """Return a table, or the number of each step."""
    if coefficient.table:
        return np.array([float(value) for value in coefficient.values], np.float32)
    if not law.modes:
        return np.full(mode.shape, float(coefficient.of(0)), np.float32)
    numbers = np.array([float(coefficient.of(k)) for k in range(len(law.modes))], np.float32)
    return numbers[mode]


def _saturated(limit: Single, value: Single) -> Single:
    return np.where(value > limit, limit, np.where(value < -limit, -limit, value))


def _interpolated(table: Single, position: Single) -> Single:
    """Return what a table has between two entries; its ends are kept, no number is its start."""
    top = np.float32(len(table) - 1)
    kept = np.where(position > 0, np.where(position < top, position, top), np.float32(0))
    index = np.minimum(kept.astype(np.uint32), len(table) - 2)
    share = kept - index.astype(np.float32)
    return np.asarray(table[index] + share * (table[index + 1] - table[index]), np.float32)


_COMPUTED: Mapping[Kind, Callable[[Single, Single], Single]] = MappingProxyType(
    {
        "add": np.add,
        "subtract": np.subtract,
        "multiply": np.multiply,
        "saturate": _saturated,
        "shift": np.add,
        "rest": np.subtract,
        "product": np.multiply,
        "divide": np.divide,
        "invert": np.divide,
        "root": lambda _, right: np.sqrt(right),
        "interpolate": _interpolated,
    }
)
