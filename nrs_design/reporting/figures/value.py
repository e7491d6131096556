"""A quadratic function along runs that stay in one mode each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.reporting.style import CYCLE, DASHES, INK, MUTED, color, legend, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.proof.matrix import RationalMatrix

# Instants, or steps, of a run, and how many of its slowest or fastest times it lasts.
_POINTS, _STEPS, _TIMES = 240, 30, 3.0


@styled
def draw_value(
    modes: Mapping[str, RationalMatrix],
    P: RationalMatrix,
    time: Time,
    start: Sequence[Fraction] | None,
    line: tuple[str, Fraction] | None,
) -> Figure:
    """Draw ``x' P x`` over its first value, along a run in each mode.

    Runs begin where all states are alike, if no start is given. The line is a label and a rate,
    alpha in 1/s or rho per step.
    """
    form = np.array(P.fractions(), dtype=float)
    matrices = {name: np.array(A.fractions(), dtype=float) for name, A in modes.items()}
    first = np.ones(len(form)) if start is None else np.array(start, dtype=float)
    first = first / np.abs(first).max()
    instants, steps = _instants(matrices, time)
    scale = abs(float(first @ form @ first)) or 1.0
    figure, axes = new_axes()
    for i, (name, A) in enumerate(matrices.items()):
        states = _run(A, first, instants, time)
        values = np.einsum("ki,ij,kj->k", states, form, states) / scale
        marker = "o" if time is Time.DISCRETE else None
        dash = DASHES[i // len(CYCLE) % len(DASHES)]
        axes.plot(
            instants, values, linestyle=dash, color=color(i), marker=marker, ms=2.5, label=name
        )
    if line is not None:
        label, rate = line
        fall = (
            np.exp(-2 * float(rate) * instants)
            if time is Time.CONTINUOUS
            else float(rate) ** (2 * instants)
        )
        axes.plot(instants, fall, ":", color=INK, label=label)
    axes.axhline(0.0, color=MUTED, linewidth=0.8)
    axes.set(xlabel=steps, ylabel="V(x) / |V(x(0))| [1]")
    legend(figure, axes)
    return figure


def _instants(matrices: Mapping[str, np.ndarray], time: Time) -> tuple[np.ndarray, str]:
    if time is Time.DISCRETE:
        return np.arange(_STEPS + 1, dtype=float), "Time [steps]"
    fastest = max(float(np.abs(np.linalg.eigvals(A)).max()) for A in matrices.values())
    return np.linspace(0.0, _TIMES / (fastest or 1.0), _POINTS), "Time [s]"


def _run(A: np.ndarray, first: np.ndarray, instants: np.ndarray, time: Time) -> np.ndarray:
    step = A
    if time is Time.CONTINUOUS:
        from scipy.linalg import expm

        step = expm(A * float(instants[1]))
    states = [first]
    for _ in instants[1:]:
        states.append(step @ states[-1])
    return np.array(states)
