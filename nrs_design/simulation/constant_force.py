"""Runs in which a constant force pushes into contact that is lost and made again."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np

from nrs_design.proof.contact import Contact
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array, Norm


def pushed_in(system: SwitchedSystem) -> SwitchedSystem:
    """Return the loop that is driven by F - Fd, with one state more for the force.

    That state, last but one, is the deflection d at which F = Fd; it does not change. After it
    comes the deflection, and so ``y' = A_yy y + h (max(delta, 0) - d)``.

    Parameters
    ----------
    system : SwitchedSystem
        In continuous time, with elastic contact that can be lost.
    """
    *others, last = system.states
    return replace(
        system,
        states=(*others, "d", last),
        modes=tuple(_driven(mode, touching=True) for mode in system.modes),
        contact=Contact(tuple(_driven(mode, touching=False) for mode in system.modes)),
        channels=(),
        outputs=(),
    )


def _driven(mode: Mode, *, touching: bool) -> Mode:
    *moving, deflecting = mode.A.fractions()
    rows = [[*row[:-1], -row[-1], row[-1] if touching else Fraction(0)] for row in moving]
    still = [Fraction(0)] * (len(deflecting) + 1)
    rows += [still, [*deflecting[:-1], Fraction(0), Fraction(0)]]
    name = mode.name if touching else f"{mode.name}, free"
    return Mode(name, RationalMatrix.from_rows(rows))


def pushed_norm(Q: Array, slope: float) -> Norm:
    """Return the root of ``w'Qw + 2 s d max(-d - e, 0)`` with ``w = (y, max(e, -d))``.

    For the states of `pushed_in`; e is the deflection less d.

    Parameters
    ----------
    Q : ndarray, shape (n, n)
        Symmetric and positive definite.
    slope : float
        The s.
    """

    def norm(states: Array) -> Array:
        *_, d, delta = np.moveaxis(states, -1, 0)
        w = np.concatenate([states[..., :-2], (np.maximum(delta, 0.0) - d)[..., None]], axis=-1)
        value = np.einsum("...i,ij,...j", w, Q, w) + 2 * slope * d * np.maximum(-delta, 0.0)
        return np.asarray(np.sqrt(np.maximum(value, 0.0)))

    return norm
