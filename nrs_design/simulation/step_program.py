"""A law that runs sample by sample: the same operations as the replica, one number at a time.

`nrs_design.controllers.replica` computes whole batches; a run has one step after the other. So the
operations are written out as a Python function of numbers, once for each mode. A test holds it
against the replica, bit for bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from nrs_design.controllers.operations import StepLaw

Step = Callable[..., tuple[list[np.float32], list[np.float32]] | None]
_SIGNS = {"add": "+", "subtract": "-", "multiply": "*"}


class StepProgram:
    """The operations of a law, for one sample at a time.

    Parameters
    ----------
    law : StepLaw
        The law.
    """

    def __init__(self, law: StepLaw) -> None:
        self.law = law
        names = [*(value.name for value in law.values), *(o.name for o in law.operations)]
        # Names of values and coefficients are ours, of `step_law`: none comes from a spec.
        self._place = {name: f"x{i}" for i, name in enumerate(names)}
        self._steps = [self._written(mode) for mode in range(len(law.modes))]
        self._zeros = [np.float32(0)] * len(law.outputs)

    def step(
        self, mode: int, given: Sequence[np.float32]
    ) -> tuple[list[np.float32], list[np.float32], bool]:
        """Compute one step.

        Parameters
        ----------
        mode : int
            Index of the controller.
        given : sequence of float32
            Inputs and states, as `StepLaw.values` lists them.

        Returns
        -------
        list, list, bool
            Outputs, states after the step, and whether it is valid: otherwise outputs are zero
            and states stay as they were.
        """
        found = self._steps[mode](*given)
        if found is None:
            return self._zeros, list(given[len(self.law.inputs) :]), False
        return *found, True

    def _written(self, mode: int) -> Step:
        """Return the step of a mode as a function of its inputs and states."""
        law, place = self.law, self._place
        known: dict[str, object] = {}
        for name, coefficient in law.coefficient.items():
            value = np.float32(float(coefficient.of(mode)))
            known[f"c_{name}"], known[f"n_{name}"] = value, -value
        known |= {f"l{i}": np.float32(float(v.limit)) for i, v in enumerate(law.values)}
        arguments = ", ".join(place[value.name] for value in law.values)
        lines = [f"def step({arguments}):", *self._lines()]
        exec("\n".join(lines), known)
        step: Step = known["step"]  # type: ignore[assignment]
        return step

    def _lines(self) -> Iterator[str]:
        law, place = self.law, self._place
        bounds = (f"-l{i} <= x{i} <= l{i}" for i in range(len(law.values)))
        yield f"    if not ({' and '.join(bounds)}): return None"
        for o in law.operations:
            right, result = place[o.right], place[o.name]
            if o.kind == "saturate":
                top, bottom = f"c_{o.left}", f"n_{o.left}"
                inner = f"{bottom} if {right} < {bottom} else {right}"
                yield f"    {result} = {top} if {right} > {top} else {inner}"
            else:
                left = f"c_{o.left}" if o.kind == "multiply" else place[o.left]
                yield f"    {result} = {left} {_SIGNS[o.kind]} {right}"
        outputs = ", ".join(place[name] for name in law.outputs.values())
        states = ", ".join(place[law.following[state.name]] for state in law.states)
        yield f"    return [{outputs}], [{states}]"
