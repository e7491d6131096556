"""The rules of switching on a grid of time, as a graph."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock, Stay
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Indices

# Most steps of a dwell time, and most nodes of the graph: beyond them the grid is coarser.
_STAY, _NODES = 40, 4000


@dataclass(frozen=True, eq=False)
class Rules:
    """A graph whose paths are the admissible signals: nodes are modes with the time spent in them.

    Every step takes one action: it resets the state, and then one mode is in force for the step.
    A run begins at node 0, in no mode yet.
    """

    # Shape (U,). Of each action: the mode, the row of `jumps`, and the node that it leads to.
    mode: Indices
    jump: Indices
    target: Indices
    jumps: Array  # Shape (J, n, n). Resets of the state; the first is the identity.
    # Shape (N, K). Admissible actions at each node; the first fills up the row.
    choices: Indices

    @classmethod
    def create(cls, system: SwitchedSystem, step: float) -> Rules:
        """Lay the rules of a system on a grid; a stay is never shorter or longer than allowed.

        The step is as `fitting_step` gives it; where modes take turns, there are no rules.
        """
        if system.clock is not None:
            return _turn_rules(system, system.clock)
        if system.switching.is_arbitrary:
            modes = np.arange(len(system.modes))
            zeros = np.zeros_like(modes)
            return cls(modes, zeros, zeros, np.eye(system.order)[None], modes[None])
        return _stay_rules(system, step)


def fitting_step(system: SwitchedSystem, step: float) -> float:
    """Return a time step in s near the requested one that divides every dwell time.

    In discrete time it stays as it is. A ValueError if the rules are too fine for a grid.
    """
    if system.time is Time.DISCRETE:
        return step
    dwells = list(system.stays().values())
    spans = [float(stay.shortest) for stay in dwells if stay.shortest > 0]
    if spans:
        step = min(spans) / min(math.ceil(min(spans) / step), _STAY)
    for _ in range(_STAY):
        if all(_counts(stay, Fraction(step)) for stay in dwells):
            return step
        step /= 2
    raise ValueError("a longest dwell time is not longer than the shortest one")


def _counts(stay: Stay, step: Fraction) -> tuple[int, int | None] | None:
    """Return the fewest steps of a stay and the most; None if there is no number between."""
    # Rounding of a dwell time adds no step.
    fewest = max(1, math.ceil(stay.shortest / step - Fraction(1, 10**9)))
    if stay.longest is None:
        return fewest, None
    highest = math.floor(stay.longest / step + Fraction(1, 10**9))
    return (fewest, highest) if highest >= fewest else None


def _turn_rules(system: SwitchedSystem, clock: Clock) -> Rules:
    """Return a node for each state of a clock, the first of which any run may begin with.

    A run from rest may rest in the first steps, so it may as well begin with the others.
    """
    graph = _Graph(system)
    kinds = clock.kind_of(mode.name for mode in system.modes)
    for node, kind, target in clock.turns():
        modes = (k for k, mode_kind in enumerate(kinds) if mode_kind == kind)
        graph.choices.setdefault(node, []).extend(graph.action(k, 0, target) for k in modes)
    return graph.rules()


def _stay_rules(system: SwitchedSystem, step: float) -> Rules:
    """Return a node for each number of steps spent in each mode; node 0 is the beginning."""
    unit = Fraction(1) if system.time is Time.DISCRETE else Fraction(step)
    dwells, modes, counts = system.stays(), system.modes, []
    for mode in modes:
        count = _counts(dwells[mode.name], unit)
        if count is None:
            raise ValueError(f"mode {mode.name} must be left before it may be")
        counts.append(count)
    # Node 0 is the start; then come the nodes of each mode after 1, 2, ... steps.
    spans = [fewest if highest is None else highest for fewest, highest in counts]
    base = np.concatenate([[1], 1 + np.cumsum(spans)]).tolist()
    if base[-1] > _NODES:
        raise ValueError(f"the rules make more than {_NODES} nodes on this grid")
    index, graph = {mode.name: k for k, mode in enumerate(modes)}, _Graph(system)
    graph.choices[0] = [graph.action(k, 0, base[k]) for k in range(len(modes))]
    exits: dict[int, list[int]] = {k: [] for k in range(len(modes))}
    for edge in system.edges():
        target, jump = index[edge.target.name], 0 if edge.map is None else graph.jump(edge.map)
        exits[index[edge.source.name]].append(graph.action(target, jump, base[target]))
    for k, (fewest, highest) in enumerate(counts):
        last = base[k + 1] - 1
        for number, node in enumerate(range(base[k], last + 1), start=1):
            successor = node + 1 if node < last else node if highest is None else None
            continuations = [] if successor is None else [graph.action(k, 0, successor)]
            graph.choices[node] = continuations + (exits[k] if number >= fewest else [])
    return graph.rules()


class _Graph:
    """Rules while their nodes are made."""

    def __init__(self, system: SwitchedSystem) -> None:
        self.actions: dict[tuple[int, int, int], int] = {}
        self.choices: dict[int, list[int]] = {}
        self.jumps: dict[int, Array] = {0: np.eye(system.order)}

    def action(self, mode: int, jump: int, target: int) -> int:
        """Return the number of an action."""
        return self.actions.setdefault((mode, jump, target), len(self.actions))

    def jump(self, map_: RationalMatrix) -> int:
        """Return the number of a reset."""
        self.jumps.setdefault(id(map_), np.array(map_.floats()))
        return list(self.jumps).index(id(map_))

    def rules(self) -> Rules:
        """Return the rules as arrays."""
        rows = [self.choices[node] for node in sorted(self.choices)]
        if not all(rows):
            raise ValueError("a mode must be left, and nothing may follow it")
        width = max(map(len, rows))
        choices = np.array([row + row[:1] * (width - len(row)) for row in rows], dtype=np.int64)
        mode, jump, target = np.array(list(self.actions), dtype=np.int64).T
        return Rules(mode, jump, target, np.array([*self.jumps.values()]), choices)
