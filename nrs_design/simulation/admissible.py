"""A bad run that keeps the rules of switching: dwell time, allowed transitions, resets."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from nrs_design.simulation.norms import Array
from nrs_design.simulation.switched import TimeResponse, times
from nrs_design.switched.system import SwitchedSystem, Time

# Fewest dwell times that a run of so many steps should hold.
_LEGS = 8
# Modes to start in; the worst run of them is kept.
_STARTS = 6


@dataclass(frozen=True)
class _Move:
    """What may happen next: the mode, the reset on entering it, how long it lasts, all in one."""

    mode: int
    reset: Array
    steps: int
    whole: Array

    @classmethod
    def into(cls, mode: int, reset: Array, steps: int, flow: Array) -> _Move:
        return cls(mode, reset, steps, np.asarray(np.linalg.matrix_power(flow, steps) @ reset))


def admissible_run(
    system: SwitchedSystem, functions: Mapping[str, Array], step: float, steps: int
) -> TimeResponse:
    """Simulate a greedy adversary that keeps the rules.

    After every dwell time it stays for another step, or switches and stays for a dwell time:
    whichever loses the least of ``sqrt(x' Q_i x)`` of the active mode per time. It is a bad run,
    not the worst one.

    Parameters
    ----------
    system : SwitchedSystem
        Modes, perhaps of different sizes, and rules.
    functions : mapping
        Matrix Q_i of every mode by its name, positive definite.
    step : float
        Wanted time between decisions, in s; the dwell time becomes a multiple of it.
    steps : int
        Number N of steps, at least.
    """
    step, dwell = _grid(system, step, steps)
    flows = _flows(system, step)
    roots = [np.asarray(np.linalg.cholesky(functions[m.name]).T) for m in system.modes]
    successors = _successors(system, flows, dwell)
    runs = []
    for mode, initial in _starts(flows, roots, successors, dwell):
        states, modes = _follow(mode, initial, flows, roots, successors, dwell, steps)
        runs.append((_kept(roots, states, modes), states, modes))
    _, states, modes = max(runs, key=lambda run: run[0])
    return TimeResponse(times(step, len(modes)), _filled(states), np.array(modes))


def active_norms(
    system: SwitchedSystem, response: TimeResponse, functions: Mapping[str, Array]
) -> Array:
    """Return ``sqrt(x' Q_i x)`` of the active mode over its first value; shape (N + 1,)."""
    active = np.append(response.mode, response.mode[-1])
    values = np.empty(len(active))
    for index in set(active.tolist()):
        Q = functions[system.modes[index].name]
        x = response.state[active == index][:, : len(Q)]
        values[active == index] = np.linalg.norm(x @ np.linalg.cholesky(Q), axis=1)
    return np.asarray(values / values[0])


def norm_ratio(functions: Mapping[str, Array]) -> float:
    """Return the constant c between the functions' bound and that in the Euclidean norm."""
    spectra = [np.linalg.eigvalsh(Q) for Q in functions.values()]
    return math.sqrt(max(float(s[-1]) for s in spectra) / min(float(s[0]) for s in spectra))


def _grid(system: SwitchedSystem, step: float, steps: int) -> tuple[float, int]:
    """Return a step that divides the dwell time, and how many make one."""
    dwell = float(system.switching.dwell_time)
    if system.time is Time.DISCRETE:
        return 1.0, max(1, int(dwell))
    if dwell == 0:
        return step, 1
    count = max(1, min(math.ceil(dwell / step), steps // _LEGS))
    return dwell / count, count


def _flows(system: SwitchedSystem, step: float) -> list[Array]:
    matrices = [np.array(mode.A.floats()) for mode in system.modes]
    if system.time is Time.DISCRETE:
        return matrices
    from scipy.linalg import expm

    return [np.asarray(expm(A * step)) for A in matrices]


def _successors(system: SwitchedSystem, flows: list[Array], dwell: int) -> list[list[_Move]]:
    """Return what may follow each mode; to stay comes first."""
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    moves = [[_Move.into(k, np.eye(len(flow)), 1, flow)] for k, flow in enumerate(flows)]
    for source, target in system.transitions():
        reset, k = system.reset_map(source, target), index[target.name]
        jump = np.eye(source.A.shape[0]) if reset is None else np.array(reset.floats())
        moves[index[source.name]].append(_Move.into(k, jump, dwell, flows[k]))
    return moves


def _starts(
    flows: list[Array], roots: list[Array], successors: list[list[_Move]], dwell: int
) -> list[tuple[int, Array]]:
    """Return some modes, each with the state that keeps the most over a dwell time and a move."""
    found = []
    for mode, moves in enumerate(successors):
        flow = np.linalg.matrix_power(flows[mode], dwell)
        best = max((_largest(roots, mode, move, flow) for move in moves), key=lambda item: item[0])
        found.append((best[0], mode, best[1]))
    found.sort(key=lambda item: -item[0])
    return [(mode, initial) for _, mode, initial in found[:_STARTS]]


def _largest(roots: list[Array], mode: int, move: _Move, flow: Array) -> tuple[float, Array]:
    """Return how much the function can keep over a switch, and the state that keeps it."""
    inverse = np.linalg.inv(roots[mode])
    _, values, right = np.linalg.svd(roots[move.mode] @ move.reset @ flow @ inverse)
    return float(values[0]), inverse @ right[0]


def _follow(
    mode: int,
    initial: Array,
    flows: list[Array],
    roots: list[Array],
    successors: list[list[_Move]],
    dwell: int,
    steps: int,
) -> tuple[list[Array], list[int]]:
    """Move on greedily until there are enough steps."""
    states, modes = [initial], []
    move = _Move.into(mode, np.eye(len(initial)), dwell, flows[mode])
    while True:
        states[-1] = move.reset @ states[-1]
        for _ in range(move.steps):
            states.append(flows[move.mode] @ states[-1])
            modes.append(move.mode)
        if len(modes) >= steps:
            return states, modes
        move = _least_loss(move.mode, states[-1], roots, successors)


def _kept(roots: list[Array], states: list[Array], modes: list[int]) -> float:
    """Return the mean growth of the active function per step, as a logarithm."""
    first = float(np.linalg.norm(roots[modes[0]] @ states[0]))
    last = float(np.linalg.norm(roots[modes[-1]] @ states[-1]))
    return math.log(last / first) / len(modes) if last > 0 else -math.inf


def _least_loss(mode: int, x: Array, roots: list[Array], successors: list[list[_Move]]) -> _Move:
    now = float(np.linalg.norm(roots[mode] @ x))

    def gain(move: _Move) -> float:
        after = float(np.linalg.norm(roots[move.mode] @ (move.whole @ x)))
        return math.log(after / now) / move.steps if after > 0 and now > 0 else -math.inf

    return max(successors[mode], key=gain)


def _filled(states: list[Array]) -> Array:
    """Fill smaller states up with zeros."""
    n = max(map(len, states))
    return np.array([np.pad(x, (0, n - len(x))) for x in states])
