"""Simulation of a periodic switching signal, from the direction that grows the most."""

from __future__ import annotations

import math
from collections.abc import Sequence
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

_SAMPLES = 4000
_FEWEST, _MOST = 3, 30
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
    legs = _legs(system, steps, edges)
    monodromy = reduce(lambda product, leg: leg.whole @ product, legs, np.eye(system.order))
    values, vectors = np.linalg.eig(monodromy)
    leading = int(np.abs(values).argmax())
    if eigenvalue is not None:
        leading = int(np.abs(values - eigenvalue).argmin())
    radius = float(np.abs(values[leading]))
    initial = vectors[:, leading].real
    initial = initial / np.linalg.norm(initial)
    response = _repeat(legs, initial, _periods(radius, sum(leg.pieces for leg in legs)))
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
    longest = _SAMPLES // _MOST if discrete else _SAMPLES // _MOST * fine_step(system)
    return math.ceil(min(times, longest)) if discrete else min(times, longest)


@dataclass(frozen=True)
class _Leg:
    """One step of the period: its mode, and its flow in pieces (the last with the reset)."""

    mode: int
    piece: Array
    last: Array
    pieces: int
    time: float

    @property
    def whole(self) -> Array:
        return np.asarray(self.last @ np.linalg.matrix_power(self.piece, self.pieces - 1))


def _legs(system: SwitchedSystem, steps: Steps, edges: Sequence[int]) -> list[_Leg]:
    fine, maps, matrices = fine_step(system), system.switching.maps(), mode_matrices(system)
    # Many steps in a period leave fewer samples for each.
    most = max(1, _SAMPLES // (_FEWEST * len(steps)))
    successors = [mode for mode, _ in (*steps[1:], *steps[:1])]
    legs = []
    for k, ((mode, time), successor) in enumerate(zip(steps, successors, strict=True)):
        A, discrete = matrices[mode], system.time is Time.DISCRETE
        pieces = int(time) if discrete else min(max(_SMOOTH, math.ceil(time / fine)), most)
        piece = A if discrete else expm(A * (time / pieces))
        resets = maps.get((system.modes[mode].name, system.modes[successor].name))
        edge = edges[k] if edges else 0
        last = piece if resets is None else np.array(resets[edge].floats()) @ piece
        legs.append(_Leg(mode, piece, last, pieces, time))
    return legs


def _repeat(legs: Sequence[_Leg], initial: Array, periods: int) -> SwitchedRun:
    states, modes, instants = [initial], [], [0.0]
    for _ in range(periods):
        for leg in legs:
            begin = instants[-1]
            for k in range(1, leg.pieces + 1):
                factor = leg.last if k == leg.pieces else leg.piece
                states.append(factor @ states[-1])
                modes.append(leg.mode)
                instants.append(begin + leg.time * k / leg.pieces)
    return SwitchedRun(np.array(instants), np.array(states), np.array(modes))


def _periods(radius: float, samples: int) -> int:
    exponent = math.log(max(radius, 1.0))
    wanted = math.ceil(math.log(_GROWTH) / exponent) if exponent > 1e-6 else _MOST
    # Three periods of a growth by many decades would leave the range of doubles.
    fewest = _FEWEST if exponent < 100 else 1
    return max(fewest, min(wanted, _MOST, _SAMPLES // samples))
