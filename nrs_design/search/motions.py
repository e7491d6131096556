"""Motions in contact and free in floating point, and the multipliers of lost contact."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.contact import Contact
from nrs_design.proof.mode import Time
from nrs_design.search.balance import mean_norm, scale_states, separating
from nrs_design.search.family import Family, to_floats

Array = NDArray[np.float64]


def free_motions(family: Family) -> Array:
    """Return the free modes in the coordinates of a family, shape (f, n, n)."""
    d = family.exponents
    free = to_floats([mode.A for mode in family.system.free]).reshape(-1, len(d), len(d))
    return scale_states(free, d)


def pulling_forces(family: Family) -> Array:
    """Return the forces of environments that could pull, shape (p, n)."""
    contact, d = family.system.contact or Contact(()), family.exponents
    rows = [to_floats([q])[0, 0] for q in contact.pulls]
    return np.asarray(np.ldexp(np.array(rows).reshape(-1, len(d)), d[None, :]))


def separating_coordinates(family: Family) -> Array:
    """Return T that makes the mean of the modes' norms round, but leaves the deflection alone."""
    return separating(mean_norm(family.matrices, family.system.time))


def multiplied(contact: Contact, time: Time) -> NDArray[np.int64]:
    """Return for each multiplier how often the deflection is in its product."""
    if time is Time.CONTINUOUS:
        return np.ones(len(contact.free) * len(contact.pulls), dtype=np.int64)
    return np.array([2, *[1, 1, 2] * len(contact.pulls)])


def in_numerators(multipliers: Array, contact: Contact, time: Time) -> Array:
    """Return multipliers of forces, in discrete time as those of their numerators."""
    if time is Time.CONTINUOUS:
        return multipliers
    below = [d for q in contact.pulls for d in (q.denominator, q.denominator, 1)]
    return np.asarray(multipliers / np.array([1, *below][: len(multipliers)], dtype=float))


def numerators(multipliers: Array, log2: int) -> tuple[int, ...]:
    """Round multipliers to integers over two to a power; none becomes negative."""
    whole = Fraction(2) ** log2
    return tuple(round(max(Fraction(float(entry)), Fraction(0)) * whole) for entry in multipliers)
