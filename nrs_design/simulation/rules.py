"""The rules of switching on a grid of time, as a graph."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

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
    def of(cls, system: SwitchedSystem, step: float) -> Rules:
        """Lay the rules of a system on a grid; a stay is never shorter or longer than allowed.

        The step is as `fitting_step` gives it; where modes take turns, there are no rules.
        """
        if system.clock is not None:
            return _turns(system, system.clock)
        if system.switching.is_arbitrary:
            modes = np.arange(len(system.modes))
            nothing = np.zeros_like(modes)
            return cls(modes, nothing, nothing, np.eye(system.order)[None], modes[None])
        return _stays_counted(system, step)


def fitting_step(system: SwitchedSystem, step: float) -> float:
    """Return a time step in s near the requested one that divides every dwell time.

    In discrete time it stays as it is. A ValueError if the rules are too fine for a grid.
    """
    if system.time is Time.DISCRETE:
        return step
    stays = list(system.stays().values())
    spans = [float(stay.shortest) for stay in stays if stay.shortest > 0]
    if spans:
        step = min(spans) / min(math.ceil(min(spans) / step), _STAY)
    for _ in range(_STAY):
        if all(_counts(stay, Fraction(step)) for stay in stays):
            return step
        step /= 2
    raise ValueError("a longest dwell time is not longer than the shortest one")


def _counts(stay: Stay, step: Fraction) -> tuple[int, int | None] | None:
    """Return the fewest steps of a stay and the most; None if there is no number between."""
    # Rounding of a dwell time adds no step.
    fewest = max(1, math.ceil(stay.shortest / step - Fraction(1, 10**9)))
    if stay.longest is None:
        return fewest, None
    most = math.floor(stay.longest / step + Fraction(1, 10**9))
    return (fewest, most) if most >= fewest else None


def _turns(system: SwitchedSystem, clock: Clock) -> Rules:
    """Return a node for each state of a clock, the first of which any run may begin with.

    A run from rest may rest in the first steps, so it may as well begin with the others.
    """
    actions: dict[tuple[int, int, int], int] = {}
    after: dict[int, list[int]] = {}
    kinds = clock.kind_of(mode.name for mode in system.modes)
    for node, kind, target in clock.turns():
        own = [k for k, of_mode in enumerate(kinds) if of_mode == kind]
        found = [actions.setdefault((k, 0, target), len(actions)) for k in own]
        after.setdefault(node, []).extend(found)
    return _packed(actions, [np.eye(system.order)], after)


def _stays_counted(system: SwitchedSystem, step: float) -> Rules:
    """Return a node for each number of steps spent in each mode; node 0 is the beginning."""
    unit = Fraction(1) if system.time is Time.DISCRETE else Fraction(step)
    stays, modes = system.stays(), system.modes
    counts = []
    for mode in modes:
        count = _counts(stays[mode.name], unit)
        if count is None:
            raise ValueError(f"mode {mode.name} must be left before it may be")
        counts.append(count)
    # Node 0 is the start; then come the nodes of each mode after 1, 2, ... steps.
    spans = [fewest if most is None else most for fewest, most in counts]
    base = np.concatenate([[1], 1 + np.cumsum(spans)]).tolist()
    if base[-1] > _NODES:
        raise ValueError(f"the rules make more than {_NODES} nodes on this grid")
    index = {mode.name: k for k, mode in enumerate(modes)}
    actions: dict[tuple[int, int, int], int] = {}
    jumps, maps = [np.eye(system.order)], dict[int, int]()

    def action(mode: int, jump: int, target: int) -> int:
        return actions.setdefault((mode, jump, target), len(actions))

    after = {0: [action(k, 0, base[k]) for k in range(len(modes))]}
    leaving: dict[int, list[int]] = {k: [] for k in range(len(modes))}
    for edge in system.edges():
        target, jump = index[edge.target.name], 0
        if edge.map is not None:
            jump = maps.setdefault(id(edge.map), len(jumps))
            if jump == len(jumps):
                jumps.append(np.array(edge.map.floats()))
        leaving[index[edge.source.name]].append(action(target, jump, base[target]))
    for k, (fewest, most) in enumerate(counts):
        last = base[k + 1] - 1
        for spent, node in enumerate(range(base[k], last + 1), start=1):
            further = node + 1 if node < last else node if most is None else None
            kept = [] if further is None else [action(k, 0, further)]
            after[node] = kept + (leaving[k] if spent >= fewest else [])
    return _packed(actions, jumps, after)


def _packed(
    actions: dict[tuple[int, int, int], int], jumps: list[Array], after: dict[int, list[int]]
) -> Rules:
    if not all(after.values()):
        raise ValueError("a mode must be left, and nothing may follow it")
    width = max(map(len, after.values()))
    choices = [after[node] + after[node][:1] * (width - len(after[node])) for node in sorted(after)]
    mode, jump, target = np.array(list(actions), dtype=np.int64).T
    return Rules(mode, jump, target, np.array(jumps), np.array(choices, dtype=np.int64))
