"""What an axis does after it has been pressed into tissue and let go, under bad switching.

It begins at rest, at the deflection at which the stiffest contact pushes back with the largest
torque of the spec. No run proves anything.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from nrs_design.proof.system import SwitchedSystem, Time
from nrs_design.simulation.contact import clipped, with_free_modes, worst_contact
from nrs_design.simulation.norms import Array, Norm, quadratic_norm
from nrs_design.simulation.switched import (
    SwitchedRun,
    fine_step,
    simulate_switching,
    worst_switching,
)

_STEPS = 1500
# A run is over when nothing is larger than this share of its limit.
_SMALL = 3e-3
# It is cut where something is so many times its limit.
_LARGE = 10.0


@dataclass(frozen=True, eq=False)
class Outputs:
    """What is watched, as rows over the state, and within which limits.

    Parameters
    ----------
    force : ndarray, shape (r, n)
        Torque in N m, at every corner of the contacts.
    velocity : ndarray, shape (n,)
        In rad/s.
    largest_force, largest_velocity : float
        Limits of the spec.
    sensed : tuple of int
        States that hold a torque which was measured before, in N m.
    """

    force: Array
    velocity: Array
    largest_force: float
    largest_velocity: float
    sensed: tuple[int, ...] = ()

    @property
    def start(self) -> Array:
        """At rest, pressed in until the stiffest contact gives the largest force, and measured."""
        start = np.zeros(len(self.velocity))
        start[list(self.sensed)] = self.largest_force
        start[-1] = self.largest_force / self.force[:, -1].max()
        return start

    def shares(self, states: Array, *, losable: bool) -> tuple[Array, Array]:
        """Return force, shape (..., r), and velocity, shape (...), over their limits.

        Parameters
        ----------
        states : ndarray, shape (..., n)
            Along a run.
        losable : bool
            There is no force where the deflection is not positive.
        """
        force = states @ self.force.T / self.largest_force
        if losable:
            force = np.where(states[..., -1:] > 0, force, 0.0)
        return force, np.asarray(states @ self.velocity / self.largest_velocity)


def simulate_release(system: SwitchedSystem, outputs: Outputs, Q: Array | None) -> SwitchedRun:
    """Simulate several adversaries, and keep the run that comes furthest beside its limits.

    Each takes at every step the mode after which something is largest: the norm of Q, the
    velocity, or the force. Where rules forbid to switch at any time, one mode holds throughout.

    Parameters
    ----------
    system : SwitchedSystem
        With the deflection as its last state.
    outputs : Outputs
        What is watched.
    Q : ndarray or None
        Of a proved function, if there is one.

    Returns
    -------
    SwitchedRun
        Its modes are those of `with_free_modes` where contact may be lost.
    """
    losable = system.contact is not None
    # A run that grows may leave the range of numbers before it is cut.
    with np.errstate(over="ignore", invalid="ignore"):
        runs = [_drawn(outputs, run, losable=losable) for run in _runs(system, outputs, Q)]
    worst = max(runs, key=lambda run: _furthest(outputs, run, losable=losable))
    second = float(system.sample_time or 1) if system.time is Time.DISCRETE else 1.0
    return SwitchedRun(second * worst.time, worst.state, worst.mode)


def _drawn(outputs: Outputs, run: SwitchedRun, *, losable: bool) -> SwitchedRun:
    """Return a run until nothing of it is large any more, or until it is far beyond its limits."""
    force, velocity = outputs.shares(run.state, losable=losable)
    size = np.maximum(np.abs(force).max(axis=1), np.abs(velocity))
    beyond = np.flatnonzero(~(size <= _LARGE))
    end = min(int(np.flatnonzero(size > _SMALL)[-1]) + 2, len(run.mode))
    if len(beyond):
        end = min(end, max(int(beyond[0]), 1))
    return SwitchedRun(run.time[: end + 1], run.state[: end + 1], run.mode[:end])


def _furthest(outputs: Outputs, run: SwitchedRun, *, losable: bool) -> float:
    force, velocity = outputs.shares(run.state, losable=losable)
    # All runs begin at the largest force, so what comes after is added up.
    return float(np.abs(force).max() + np.abs(velocity).max())


def _runs(system: SwitchedSystem, outputs: Outputs, Q: Array | None) -> Iterator[SwitchedRun]:
    step, start = fine_step(system), outputs.start
    if not system.switching.is_arbitrary:
        for mode in range(len(system.modes)):
            signal = np.full(_STEPS, mode, dtype=np.int64)
            yield simulate_switching(system, signal, start, step)
        return
    sizes = [_size(outputs.velocity[None, :]), _size(outputs.force)]
    for norm in ([] if Q is None else [quadratic_norm(Q)]) + sizes:
        if system.contact is None:
            yield worst_switching(system, norm, start, step, _STEPS)
        else:
            yield worst_contact(system, clipped(norm), start, step, _STEPS)


def _size(rows: Array) -> Norm:
    return lambda states: np.asarray(np.abs(states @ rows.T).max(axis=-1))


def watched(system: SwitchedSystem) -> SwitchedSystem:
    """Return the family whose modes a run of `simulate_release` counts."""
    return system if system.contact is None else with_free_modes(system)


def certified(rows: Array, Q: Array, start: Array, rate: float, time: Array) -> Array:
    """Return how large ``|row w|`` can be at most along a run that a quadratic function bounds.

    From ``|w(t)| <= exp(-rate t) |w(0)|`` in the norm of Q, for the largest of all rows.

    Parameters
    ----------
    rows : ndarray, shape (r, n)
        Of outputs.
    Q : ndarray, shape (n, n)
        Positive definite.
    start : ndarray, shape (n,)
        The w at time zero.
    rate : float
        The proved one, in 1/s.
    time : ndarray, shape (N + 1,)
        In s.
    """
    reach = np.sqrt(np.einsum("ri,ri->r", rows, np.linalg.solve(Q, rows.T).T).max())
    return np.asarray(reach * np.sqrt(start @ Q @ start) * np.exp(-rate * time))
