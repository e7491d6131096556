"""A step of a law in NumPy's single precision: bit for bit what the exported C computes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.operations import StepLaw

Single = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class StepResult:
    """What a step leaves, for a batch.

    Parameters
    ----------
    outputs, states : mapping of str to ndarray
        By name; single precision, shape (n,).
    valid : ndarray of bool
        Shape (n,). Where a step is not valid, outputs are zero and states stay as they were.
    """

    outputs: Mapping[str, Single]
    states: Mapping[str, Single]
    valid: NDArray[np.bool_]


def step(law: StepLaw, mode: NDArray[np.uint32], given: Mapping[str, Single]) -> StepResult:
    """Compute one step for a batch, with one rounding for each operation.

    Parameters
    ----------
    law : StepLaw
        The law.
    mode : ndarray of uint32
        Shape (n,); one that there is not makes the step invalid.
    given : mapping of str to ndarray
        Inputs and states by name; single precision, shape (n,).
    """
    valid = mode < len(law.modes)
    for value in law.values:
        limit = np.float32(float(value.limit))
        valid = valid & (given[value.name] >= -limit) & (given[value.name] <= limit)
    known: dict[str, Single] = {
        value.name: np.where(valid, given[value.name], np.float32(0)) for value in law.values
    }
    for c in law.coefficients:
        numbers = np.array([float(c.of(k)) for k in range(len(law.modes))], np.float32)
        known[c.name] = numbers[np.where(valid, mode, 0)]
    for operation in law.operations:
        left, right = known[operation.left], known[operation.right]
        if operation.kind == "add":
            known[operation.name] = left + right
        elif operation.kind == "subtract":
            known[operation.name] = left - right
        elif operation.kind == "multiply":
            known[operation.name] = left * right
        else:
            known[operation.name] = np.where(
                right > left, left, np.where(right < -left, -left, right)
            )
    outputs = {
        name: np.where(valid, known[value], np.float32(0)) for name, value in law.outputs.items()
    }
    states = {
        name: np.where(valid, known[value], given[name]) for name, value in law.following.items()
    }
    return StepResult(outputs, states, valid)
