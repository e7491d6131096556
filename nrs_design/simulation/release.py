"""Runs of an axis that is pressed into tissue and released, under adverse switching.

It begins at rest, at the deflection at which the stiffest contact pushes back with the largest
torque of the spec. No run proves anything.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.greedy import greedy_run
from nrs_design.simulation.norms import Array, Norm, clipped, quadratic_norm
from nrs_design.simulation.switched import (
    SwitchedRun,
    fine_step,
    simulate_switching,
)

_STEPS = 1500
# A run is over when nothing is larger than this share of its limit.
_SMALL = 3e-3
# One that ends beyond so many times its limit is cut where it first was.
_LARGE = 10.0


@dataclass(frozen=True, eq=False)
class Outputs:
    """What is watched, as rows over the state, and within which limits."""

    force: Array  # Shape (r, n). Torque in N m, at every corner of the contacts.
    # Shape (1, n). In rad/s; a row for each mode where a command moves the axis at once.
    velocity: Array
    deflection: Array | None  # Shape (n,). In rad; None where the state does not tell it.
    pressed: Array  # Shape (n,). A state at rest in which the contacts are pressed in.
    # largest_force, largest_velocity: limits of the spec.
    largest_force: float
    largest_velocity: float
    sensed: tuple[int, ...] = ()  # States that hold a torque which was measured before, in N m
    free: tuple[int, ...] = ()  # Modes in which nothing is touched, whatever the deflection

    @property
    def start(self) -> Array:
        """At rest, pressed in until the stiffest contact gives the largest force, and measured."""
        start = self.pressed * (self.largest_force / (self.force @ self.pressed).max())
        start[list(self.sensed)] = self.largest_force
        return np.asarray(start)

    def shares(self, run: SwitchedRun, *, losable: bool) -> tuple[Array, Array]:
        """Return force, shape (N + 1, r), and velocity, shape (N + 1,), over their limits.

        Where contact is `losable`, there is no force unless the last state, the deflection, is
        positive.
        """
        states, mode = run.state, np.append(run.mode, run.mode[-1:])
        force = states @ self.force.T / self.largest_force
        if losable:
            force = np.where(states[:, -1:] > 0, force, 0.0)
        force[np.isin(mode, self.free)] = 0.0
        rows = self.velocity if len(self.velocity) == 1 else self.velocity[mode]
        return force, np.asarray((states * rows).sum(axis=1) / self.largest_velocity)


def simulate_release(system: SwitchedSystem, outputs: Outputs, Q: Array | None) -> SwitchedRun:
    """Simulate an adversary, and keep the run that comes furthest beside its limits.

    He takes at every step the mode after which the norm of a proved Q is largest; without a Q, the
    velocity. Modes that take turns keep them; where rules forbid to switch at any time, each mode
    in turn holds throughout. The last state is the deflection where contact may be lost by
    it; the modes of the run are those of `all_modes`.
    """
    losable = system.contact is not None
    # A run that grows may leave the range of numbers before it is cut.
    with np.errstate(over="ignore", invalid="ignore"):
        runs = [_drawn(outputs, run, losable=losable) for run in _runs(system, outputs, Q)]
    worst = max(runs, key=lambda run: _furthest(outputs, run, losable=losable))
    second = float(system.sample_time or 1) if system.time is Time.DISCRETE else 1.0
    return SwitchedRun(second * worst.time, worst.state, worst.mode)


def _drawn(outputs: Outputs, run: SwitchedRun, *, losable: bool) -> SwitchedRun:
    """Return a run until nothing of it is large any more, or until it grows beyond its limits."""
    force, velocity = outputs.shares(run, losable=losable)
    size = np.maximum(np.abs(force).max(axis=1), np.abs(velocity))
    beyond = np.flatnonzero(~(size <= _LARGE))
    end = min(int(np.flatnonzero(size > _SMALL)[-1]) + 2, len(run.mode))
    # What comes back is shown whole.
    if len(beyond) and beyond[-1] == len(size) - 1:
        end = min(end, max(int(beyond[0]), 1))
    return SwitchedRun(run.time[: end + 1], run.state[: end + 1], run.mode[:end])


def _furthest(outputs: Outputs, run: SwitchedRun, *, losable: bool) -> float:
    force, velocity = outputs.shares(run, losable=losable)
    # All runs begin at the largest force, so what comes after is added up.
    return float(np.abs(force).max() + np.abs(velocity).max())


def _runs(system: SwitchedSystem, outputs: Outputs, Q: Array | None) -> Iterator[SwitchedRun]:
    step, start = fine_step(system), outputs.start
    if not system.switching.is_arbitrary:
        for mode in range(len(system.modes)):
            signal = np.full(_STEPS, mode, dtype=np.int64)
            yield simulate_switching(system, signal, start, step)
        return
    norm = _speed(outputs.velocity) if Q is None else quadratic_norm(Q)
    kept = norm if system.contact is None else clipped(norm)
    yield greedy_run(system, kept, start, step, _STEPS)


def _speed(rows: Array) -> Norm:
    return lambda states: np.asarray(np.abs(states @ rows.T).max(axis=-1))


def certified(rows: Array, Q: Array, start: Array, rate: float, time: Array) -> Array:
    """Return how large ``|row w|`` can be at most along a run that a quadratic function bounds.

    From ``|w(t)| <= exp(-rate t) |w(0)|`` in the norm of Q, for the largest of all rows; the rate
    is in 1/s.
    """
    reach = np.sqrt(np.einsum("ri,ri->r", rows, np.linalg.solve(Q, rows.T).T).max())
    return np.asarray(reach * np.sqrt(start @ Q @ start) * np.exp(-rate * time))
