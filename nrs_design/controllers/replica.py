"""A step of a law in NumPy's single precision: bit for bit what the exported C computes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
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

    A mode that there is not makes the step invalid.
    """
    valid = mode < len(law.modes)
    for value in law.values:
        most = np.float32(float(value.limit))
        valid = valid & (given[value.name] >= -most) & (given[value.name] <= most)
    known: dict[str, Single] = {
        value.name: np.where(valid, given[value.name], np.float32(0)) for value in law.values
    }
    known |= {c.name: _numbers(law, c, np.where(valid, mode, 0)) for c in law.coefficients}
    known = law.read(known, _COMPUTED)
    outputs = {
        name: np.where(valid, known[value], np.float32(0)) for name, value in law.outputs.items()
    }
    states = {
        name: np.where(valid, known[value], given[name]) for name, value in law.following.items()
    }
    return StepResult(outputs, states, valid)


def _numbers(law: StepLaw, coefficient: Coefficient, mode: NDArray[np.uint32]) -> Single:
    """Return the number of each step."""
    numbers = np.array([float(coefficient.of(k)) for k in range(len(law.modes))], np.float32)
    return numbers[mode]


def _saturated(limit: Single, value: Single) -> Single:
    return np.where(value > limit, limit, np.where(value < -limit, -limit, value))


_COMPUTED: Mapping[Kind, Callable[[Single, Single], Single]] = MappingProxyType(
    {
        "add": np.add,
        "subtract": np.subtract,
        "multiply": np.multiply,
        "saturate": _saturated,
    }
)
