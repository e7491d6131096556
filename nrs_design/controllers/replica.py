"""A step of a law in NumPy's single precision: bit for bit what the exported C computes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import add, mul, sub

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.operations import Kind, StepLaw

Single = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class StepResult:
    """What a step leaves, for a batch."""

    # outputs, states: by name; single precision, shape (n,).
    outputs: Mapping[str, Single]
    states: Mapping[str, Single]
    # Shape (n,). An invalid step has zero outputs and unchanged states.
    valid: NDArray[np.bool_]


def _saturated(limit: np.float32, value: np.float32) -> np.float32:
    if value > limit:
        return limit
    return -limit if value < -limit else value


_COMPUTED: Mapping[Kind, Callable[[np.float32, np.float32], np.float32]] = {
    "add": add,
    "subtract": sub,
    "multiply": mul,
    "saturate": _saturated,
}


class StepProgram:
    """The operations of a law, for one sample at a time: arrays of one number are slow."""

    def __init__(self, law: StepLaw) -> None:
        self.law = law
        limits = [np.float32(float(value.limit)) for value in law.values]
        self._limits = [(-limit, limit) for limit in limits]
        self._numbers = [
            [np.float32(float(c.number(mode))) for c in law.coefficients]
            for mode in range(len(law.modes))
        ]
        # All values of a step are in one list, in this order.
        names = [*(value.name for value in law.values), *(c.name for c in law.coefficients)]
        places = {name: i for i, name in enumerate(names)}
        self._operations = []
        for operation in law.operations:
            operands = places[operation.first], places[operation.second]
            self._operations.append((_COMPUTED[operation.kind], *operands))
            places[operation.name] = len(places)
        self._outputs = [places[name] for name in law.outputs.values()]
        self._states = [places[law.following[state.name]] for state in law.states]

    def step(
        self, mode: int, values: Sequence[np.float32]
    ) -> tuple[list[np.float32], list[np.float32], bool]:
        """Compute one step; return outputs, states after it, and whether it is valid.

        Inputs and states are given as `StepLaw.values` lists them. A step in a mode that does not
        exist, or from a value beyond its limit, is not valid: outputs are zero and states stay as
        they were.
        """
        valid = mode < len(self._numbers)
        for value, (low, high) in zip(values, self._limits, strict=True):
            if not low <= value <= high:
                valid = False
        if not valid:
            return [np.float32(0)] * len(self._outputs), [*values[len(self.law.inputs) :]], False
        found = [*values, *self._numbers[mode]]
        for compute, left, right in self._operations:
            found.append(compute(found[left], found[right]))
        return [found[i] for i in self._outputs], [found[i] for i in self._states], True


def step(law: StepLaw, mode: NDArray[np.uint32], values: Mapping[str, Single]) -> StepResult:
    """Compute one step for a batch, shape (n,), with one rounding for each operation."""
    program = StepProgram(law)
    rows = zip(*(values[value.name] for value in law.values), strict=True)
    steps = [program.step(k, row) for k, row in zip(mode.tolist(), rows, strict=True)]
    outputs, states, valid = zip(*steps, strict=True)

    def columns(names: Sequence[str], table: Sequence[Sequence[np.float32]]) -> dict[str, Single]:
        return {n: np.array(c) for n, c in zip(names, zip(*table, strict=True), strict=True)}

    after = columns([state.name for state in law.states], states)
    return StepResult(columns(list(law.outputs), outputs), after, np.array(valid))
