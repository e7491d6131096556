"""Simulation of a periodic switching signal, from the direction that grows the most."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array
from nrs_design.simulation.switched import SwitchedRun, expm, fine_step, mode_matrices

# Mode index and time spent in it, in s or steps.
Steps = Sequence[tuple[int, float]]
# Mode index and duration of a part of a step, with its map.
_Piece = tuple[int, float, Array]

_SAMPLES = 4000
_FEWEST, _MAX_PERIODS = 3, 30
# Samples in one step of the period, for a smooth curve.
_SMOOTH = 24
# Visible growth of a state.
_GROWTH = 100.0


@dataclass(frozen=True)
class PeriodicRun:
    """A run over some periods."""

    response: SwitchedRun  # The run
    period: float  # In s, or steps
    radius: float  # Spectral radius over one period: the factor of growth in the long run


def periodic_run(
    system: SwitchedSystem,
    steps: Steps,
    edges: Sequence[int] = (),
    eigenvalue: float | None = None,
) -> PeriodicRun:
    """Simulate a periodic signal until its growth can be seen.

    The run ends when the state has grown a hundredfold, but not before three periods (if that is
    not too far), nor after thirty. It begins in the direction of the nearest eigenvalue of one
    period, by default the largest. `edges`: which reset each step takes, where there is a choice.
    """
    modes, times, factors = zip(*_pieces(system, steps, edges), strict=True)
    monodromy = reduce(lambda product, factor: factor @ product, factors)
    values, vectors = np.linalg.eig(monodromy)
    leading = int(np.abs(values).argmax())
    if eigenvalue is not None:
        leading = int(np.abs(values - eigenvalue).argmin())
    radius = float(np.abs(values[leading]))
    initial = vectors[:, leading].real
    states, periods = [initial / np.linalg.norm(initial)], _periods(radius, len(factors))
    for factor in factors * periods:
        states.append(factor @ states[-1])
    instants = np.cumsum([0.0, *times * periods])
    response = SwitchedRun(instants, np.array(states), np.array(modes * periods))
    return PeriodicRun(response, sum(time for _, time in steps), radius)


def mixture_matrix(system: SwitchedSystem, weights: Sequence[tuple[str, Fraction]]) -> Array:
    """Return the weighted sum of modes in floating point."""
    names = (mode.name for mode in system.modes)
    modes = dict(zip(names, mode_matrices(system), strict=True))
    return np.asarray(sum(float(w) * modes[name] for name, w in weights))


def time_of_growth(eigenvalue: complex, system: SwitchedSystem) -> float:
    """Return a time in s, or steps, so that a few times this show how one mode grows."""
    discrete = system.time is Time.DISCRETE
    rate = math.log(max(abs(eigenvalue), 1.0)) if discrete else eigenvalue.real
    times = math.log(_GROWTH) / _FEWEST / rate if rate > 0 else math.inf
    longest = _SAMPLES // _MAX_PERIODS if discrete else _SAMPLES // _MAX_PERIODS * fine_step(system)
    return math.ceil(min(times, longest)) if discrete else min(times, longest)


def _pieces(system: SwitchedSystem, steps: Steps, edges: Sequence[int]) -> Iterator[_Piece]:
    """Yield a period in pieces, the last of each step with the reset that follows it."""
    fine, maps, matrices = fine_step(system), system.switching.maps(), mode_matrices(system)
    # Many steps in a period leave fewer samples for each.
    max_count = max(1, _SAMPLES // (_FEWEST * len(steps)))
    for k, (mode, time) in enumerate(steps):
        A, discrete = matrices[mode], system.time is Time.DISCRETE
        count = int(time) if discrete else min(max(_SMOOTH, math.ceil(time / fine)), max_count)
        factor = A if discrete else expm(A * (time / count))
        yield from [(mode, time / count, factor)] * (count - 1)
        successor, _ = steps[(k + 1) % len(steps)]
        resets = maps.get((system.modes[mode].name, system.modes[successor].name))
        if resets is not None:
            factor = np.array(resets[edges[k] if edges else 0].floats()) @ factor
        yield mode, time / count, factor


def _periods(radius: float, samples: int) -> int:
    exponent = math.log(max(radius, 1.0))
    periods = math.ceil(math.log(_GROWTH) / exponent) if exponent > 1e-6 else _MAX_PERIODS
    # Three periods of a growth by many decades would leave the range of doubles.
    fewest = _FEWEST if exponent < 100 else 1
    return max(fewest, min(periods, _MAX_PERIODS, _SAMPLES // samples))
