"""A law that runs sample by sample: the same operations as the replica, one number at a time.

`nrs_design.controllers.replica` computes whole batches; a run has one step after the other, and
arrays of one number are slow. A test holds it against the replica, bit for bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from operator import add, mul, sub
from types import MappingProxyType

import numpy as np

from nrs_design.controllers.operations import Kind, StepLaw


def _saturated(limit: np.float32, value: np.float32) -> np.float32:
    if value > limit:
        return limit
    return -limit if value < -limit else value


_COMPUTED: Mapping[Kind, Callable[[np.float32, np.float32], np.float32]] = MappingProxyType(
    {
        "add": add,
        "subtract": sub,
        "multiply": mul,
        "saturate": _saturated,
    }
)


class StepProgram:
    """The operations of a law, for one sample at a time."""

    def __init__(self, law: StepLaw) -> None:
        self.law = law
        limits = [np.float32(float(value.limit)) for value in law.values]
        self._limits = [(-limit, limit) for limit in limits]
        self._numbers = [
            [np.float32(float(c.of(mode))) for c in law.coefficients]
            for mode in range(len(law.modes))
        ]
        # All values of a step are in one list, in this order.
        names = [*(value.name for value in law.values), *(c.name for c in law.coefficients)]
        places = {name: i for i, name in enumerate(names)}
        self._operations = []
        for operation in law.operations:
            operands = places[operation.left], places[operation.right]
            self._operations.append((_COMPUTED[operation.kind], *operands))
            places[operation.name] = len(places)
        self._outputs = [places[name] for name in law.outputs.values()]
        self._states = [places[law.following[state.name]] for state in law.states]

    def step(
        self, mode: int, given: Sequence[np.float32]
    ) -> tuple[list[np.float32], list[np.float32], bool]:
        """Compute one step; return outputs, states after it, and whether it is valid.

        Inputs and states are given as `StepLaw.values` lists them. If it is not valid, outputs are
        zero and states stay as they were.
        """
        for value, (low, high) in zip(given, self._limits, strict=True):
            if not low <= value <= high:
                return [np.float32(0)] * len(self._outputs), [*given[len(self.law.inputs) :]], False
        found = [*given, *self._numbers[mode]]
        for compute, left, right in self._operations:
            found.append(compute(found[left], found[right]))
        return [found[i] for i in self._outputs], [found[i] for i in self._states], True
