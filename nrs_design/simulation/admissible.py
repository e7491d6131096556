"""A bad run that keeps the rules of switching: dwell time, allowed transitions, resets."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array
from nrs_design.simulation.switched import SwitchedRun, expm, mode_matrices

# Fewest dwell times in a run.
_LEGS = 8
# Modes to start in; the worst run of them is kept.
_STARTS = 6


@dataclass(frozen=True)
class _Pace:
    """Step in s of a mode, its flow, and the fewest and most steps of a stay."""

    step: float
    flow: Array
    fewest: int
    most: float

    @classmethod
    def of(cls, A: Array, stay: Stay, time: Time, step: float, steps: int) -> _Pace:
        """Choose a step that divides the dwell time, or ends before the mode is left."""
        if time is Time.DISCRETE:
            most = math.inf if stay.longest is None else int(stay.longest)
            return cls(1.0, A, int(stay.shortest), most)
        fewest, length = 1, Fraction(step)
        if stay.shortest > 0:
            fewest = max(1, min(math.ceil(stay.shortest / length), steps // _LEGS))
            length = stay.shortest / fewest
        elif stay.longest is not None:
            length = min(length, stay.longest)
        most = math.inf if stay.longest is None else int(stay.longest / length)
        return cls(float(length), np.asarray(expm(A * float(length))), fewest, most)


@dataclass(frozen=True)
class _Move:
    """Next mode, its reset, its number of steps, their time in s, and the map of all."""

    mode: int
    reset: Array
    steps: int
    time: float
    whole: Array

    @classmethod
    def into(cls, mode: int, reset: Array, steps: int, pace: _Pace) -> _Move:
        whole = np.linalg.matrix_power(pace.flow, steps) @ reset
        return cls(mode, reset, steps, steps * pace.step, np.asarray(whole))


def admissible_run(
    system: SwitchedSystem, functions: Mapping[str, Array], step: float, steps: int
) -> SwitchedRun:
    """Simulate a greedy adversary that keeps the rules.

    After every dwell time it stays for another step, of nearly `step` s, if the mode need not be
    left, or switches and stays for a dwell time: whichever loses the least of ``sqrt(x' Q_i x)`` of
    the active mode per time. It is a bad run, of at least `steps` steps, not the worst one.
    `functions` are the positive definite Q_i by mode.
    """
    stays = system.stays()
    paces = [
        _Pace.of(A, stays[mode.name], system.time, step, steps)
        for mode, A in zip(system.modes, mode_matrices(system), strict=True)
    ]
    roots = [np.asarray(np.linalg.cholesky(functions[m.name]).T) for m in system.modes]
    adversary = _Adversary(paces, roots, _successors(system, paces))
    runs = [adversary.follow(mode, initial, steps) for mode, initial in adversary.starts()]
    states, modes = max(runs, key=lambda run: adversary.kept(*run))
    instants = np.concatenate([[0.0], np.cumsum([paces[mode].step for mode in modes])])
    size = max(map(len, states))
    filled = np.array([np.pad(x, (0, size - len(x))) for x in states])
    return SwitchedRun(instants, filled, np.array(modes))


def active_norms(
    system: SwitchedSystem, response: SwitchedRun, functions: Mapping[str, Array]
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


def _successors(system: SwitchedSystem, paces: list[_Pace]) -> list[list[_Move]]:
    """Return what may follow each mode; to stay comes first."""
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    moves = [[_Move.into(k, np.eye(len(pace.flow)), 1, pace)] for k, pace in enumerate(paces)]
    for edge in system.edges():
        k = index[edge.target.name]
        jump = np.eye(len(paces[k].flow)) if edge.map is None else np.array(edge.map.floats())
        moves[index[edge.source.name]].append(_Move.into(k, jump, paces[k].fewest, paces[k]))
    return moves


@dataclass(frozen=True)
class _Adversary:
    """Pace, root of the function and successors of every mode."""

    paces: list[_Pace]
    roots: list[Array]
    successors: list[list[_Move]]

    def starts(self) -> list[tuple[int, Array]]:
        """Return modes, each with the state that keeps most over a dwell time and a move."""
        found = []
        for mode, moves in enumerate(self.successors):
            inverse = np.linalg.inv(self.roots[mode])
            flow = np.linalg.matrix_power(self.paces[mode].flow, self.paces[mode].fewest)
            maps = (self.roots[move.mode] @ move.reset @ flow @ inverse for move in moves)
            _, values, right = max(map(np.linalg.svd, maps), key=lambda item: item[1][0])
            found.append((values[0], mode, inverse @ right[0]))
        found.sort(key=lambda item: -item[0])
        return [(mode, initial) for _, mode, initial in found[:_STARTS]]

    def follow(self, mode: int, initial: Array, steps: int) -> tuple[list[Array], list[int]]:
        """Move on greedily until there are enough steps."""
        states, modes, pace = [initial], list[int](), self.paces[mode]
        move, stayed = _Move.into(mode, np.eye(len(initial)), pace.fewest, pace), 0
        while True:
            states[-1] = move.reset @ states[-1]
            for _ in range(move.steps):
                states.append(self.paces[move.mode].flow @ states[-1])
                modes.append(move.mode)
            if len(modes) >= steps:
                return states, modes
            mode, stayed = move.mode, stayed + move.steps
            # To stay comes first.
            must_leave = stayed + 1 > self.paces[mode].most
            moves = self.successors[mode][int(must_leave) :]
            if not moves:
                # No mode may follow.
                return states, modes
            move = max(moves, key=partial(self._gain, mode, states[-1]))
            stayed = stayed if move.mode == mode else 0

    def _gain(self, mode: int, x: Array, move: _Move) -> float:
        return self._growth((mode, x), (move.mode, move.whole @ x), time=move.time)

    def kept(self, states: list[Array], modes: list[int]) -> float:
        """Return the mean growth of the active function per time, as a logarithm."""
        time = sum(self.paces[mode].step for mode in modes)
        return self._growth((modes[0], states[0]), (modes[-1], states[-1]), time=time)

    def _growth(self, *ends: tuple[int, Array], time: float) -> float:
        now, after = (float(np.linalg.norm(self.roots[mode] @ x)) for mode, x in ends)
        return math.log(after / now) / time if after > 0 and now > 0 else -math.inf
