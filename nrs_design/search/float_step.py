"""A step of the proof in floating point (untrusted)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.steps import Step

Array = NDArray[np.float64]
Row = tuple[str, Array]


@dataclass(frozen=True)
class FloatStep:
    """A step in the units of the system, and the facts that hold in it, by name."""

    M: Array
    errors: tuple[tuple[str, int, Array], ...]  # Entry e of z and row q: ``e^2 <= (q z)^2``
    crossings: tuple[Row, ...]  # Row c: ``delta (c z) <= 0``
    products: tuple[tuple[str, Array, Array], ...]  # Rows l and r: ``(l z) (r z) >= 0``

    @classmethod
    def of(cls, step: Step) -> FloatStep:
        """Convert a step."""
        units = step.units

        def floats(entries: Sequence[int], below: int = 1) -> Array:
            row = [_ratio(e, unit * below) for e, unit in zip(entries, units, strict=False)]
            return np.array(row + [0.0] * (len(units) - len(row)))

        return cls(
            np.array([floats(entries, step.over) for entries in step.rows]),
            tuple((name, i, floats(q, below)) for name, i, q, below in step.errors),
            tuple((name, floats(c, below)) for name, c, below in step.crossings),
            tuple((name, floats(left), floats(right)) for name, left, right in step.products),
        )


def _ratio(above: int, below: int) -> float:
    try:
        return above / below
    except OverflowError:
        return inf
