"""A bad run: at every step the adversary takes the possible mode that makes a norm largest."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Indices, Norm
from nrs_design.simulation.rules import Rules
from nrs_design.simulation.saturation import saturated_step
from nrs_design.simulation.switched import SwitchedRun, all_modes, transition_matrices


def greedy_run(
    system: SwitchedSystem,
    norms: Norm | Sequence[Norm],
    initial: Array,
    step: float,
    steps: int,
) -> SwitchedRun:
    """Simulate the greedy adversary: always the possible mode after which the norm is largest.

    Modes in contact are possible while the deflection, the last state, is positive, and free modes
    while it is not; in continuous time contact changes at the end of a step only, so steps, in s,
    must be short. The rules of switching are kept on this grid, which `fitting_step` gives. It is a
    bad run, not the worst one: nothing is proved by it. Norms take states of shape (..., n); there
    is one, or one for each state of a clock, or for each mode where switching is ruled. At time
    zero a round begins, or no deadline has been missed. The modes of the run are those of
    `all_modes`. A ValueError if the rules are too fine for this grid.
    """
    key_norms, full_system = [norms] if callable(norms) else list(norms), all_modes(system)
    rules, advance = Rules.create(full_system, step), _advance(system, step)
    action_keys = (rules.mode if system.clock is None else rules.target) % len(key_norms)
    free = np.arange(len(full_system.modes)) >= len(system.modes)
    states, actions, node = [initial], list[int](), 0
    for _ in range(steps):
        choices = rules.choices[node]
        possible = free[rules.mode[choices]] == (free.any() and states[-1][-1] <= 0)
        choices = np.unique(choices[possible])
        jumped = rules.jumps[rules.jump[choices]] @ states[-1]
        candidates, keys = advance(jumped, rules.mode[choices]), action_keys[choices]
        values = np.empty(len(choices))
        for key in {*keys.tolist()}:
            values[keys == key] = key_norms[key](candidates[keys == key])
        best = int(values.argmax())
        actions.append(int(choices[best]))
        states.append(candidates[best])
        node = int(rules.target[actions[-1]])
    unit = 1.0 if system.time is Time.DISCRETE else step
    turns = (rules.mode if system.clock is None else rules.target)[actions]
    first = turns[0] if system.clock is None else 0
    instants = unit * np.arange(steps + 1.0)
    return SwitchedRun(instants, np.array(states), rules.mode[actions], np.array([first, *turns]))


def relative_norms(run: SwitchedRun, norms: Norm | Sequence[Norm]) -> Array:
    """Return the norm along a run over its first value, as `greedy_run` takes it; shape (N + 1,).

    Of each mode, it is that of the mode in which a state was reached.
    """
    if callable(norms):
        values = norms(run.state)
    else:
        assert run.turn is not None
        pairs = zip(run.turn.tolist(), run.state, strict=True)
        values = np.array([norms[turn](x) for turn, x in pairs])
    return np.asarray(values / values[0])


def slowest(
    system: SwitchedSystem,
    norms: Norm | Sequence[Norm],
    directions: Iterable[Array],
    step: float,
    steps: int,
) -> Array:
    """Return the state, among some, from which greedy runs of so many steps keep the most."""

    def remainder(x: Array) -> float:
        return float(relative_norms(greedy_run(system, norms, x, step, steps), norms)[-1])

    return max(directions, key=remainder)


def _advance(system: SwitchedSystem, step: float) -> Callable[[Array, Indices], Array]:
    """Return the function from states and modes to the states after a step, one for each."""
    if system.saturation is not None:
        saturated = saturated_step(system, step)
        # Nothing resets its state.
        return lambda states, modes: saturated(states[0], modes)
    maps = transition_matrices(all_modes(system), step)
    return lambda states, modes: (maps[modes] @ states[:, :, None])[:, :, 0]
