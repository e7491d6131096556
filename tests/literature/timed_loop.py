"""Sampled loops whose periods and delays are anywhere in intervals, as switched systems of stays.

A sample is followed by the next one after h, and by the command u = K x that is computed of it
after d <= h, while the one before, u', is held. Then the plant x' = A x + B u is at the next one at

    x+ = exp(A h) (x - int_0^d exp(-A s) ds B (u - u')) + int_0^h exp(A s) ds B u

So a period is two stays in turn: in mode ``delay``, for d, x moves by the first integral, and in
mode ``period``, for h, by A x + B u. A command that is late by whole periods waits as a state.
"""

from fractions import Fraction
from itertools import pairwise

import numpy as np
from scipy.linalg import expm

from nrs_design.proof.switching import Stay, Switching
from tests.proof.systems import family, resets_between


def exact(rows):
    """Return a matrix of fractions."""
    return np.array([[Fraction(str(entry)) for entry in row] for row in rows], dtype=object)


def floats(rows):
    return exact(rows).astype(float)


def timed(plant, K, period, delay=None):
    """Return the system of a loop; times are in s, with both ends.

    States are x, what a late command leaves out, commands that wait, and the one that is held.
    """
    (A, B), K = map(exact, plant), exact(K)
    first, last = map(Fraction, period)
    delays = [Fraction(end) for end in delay or (0, 0)]
    waiting = int(delays[0] // first) if first == last else 0
    rests = [end - waiting * first for end in delays]
    (n, m), late = B.shape, rests[1] > 0
    begins = [n * (1 + late) + m * k for k in range(waiting + 2)]
    x, left, order = slice(0, n), slice(n, begins[0]), begins[-1]
    newest, *others = commands = [slice(*ends) for ends in pairwise(begins)]
    held, unit = commands[-1], exact(np.eye(order, dtype=int))
    flow, sample = 0 * unit, 0 * unit
    flow[x, x], flow[x, held] = A, B
    sample[x, x], sample[newest, x] = unit[x, x], K
    for before, after in zip(commands, others, strict=False):
        sample[after, before] = unit[before, before]
    stays = [Stay(first, last)] * 2
    if late:
        sample[left] = B @ (sample[held] - unit[held])
        less, kept = 0 * unit, unit.copy()
        less[x, left], less[left, left] = -unit[x, x], -A
        kept[left] = 0 * kept[left]
        turns = (("delay", less, kept), ("period", flow, sample))
        stays[0] = Stay(*rests)
    else:
        turns = (("period/1", flow, sample), ("period/2", flow, sample))
    names = [name for name, _, _ in turns]
    ends = zip(turns, reversed(names), strict=True)
    resets = resets_between(*((name, other, rows) for (name, _, rows), other in ends))
    rules = Switching(resets=resets, stays=tuple(zip(names, stays, strict=True)))
    return family(*(rows for _, rows, _ in turns), names=names, switching=rules)


def parts(A, B, h, d):
    """Return what the state, the command before and the new one do to the next state."""
    n, m = B.shape
    flows = [expm(np.block([[A, B], [np.zeros((m, n + m))]]) * time) for time in (d, h - d)]
    (E1, G1), (E2, G2) = ((flow[:n, :n], flow[:n, n:]) for flow in flows)
    return E2 @ E1, E2 @ G1, G2


def sampled(A, B, h, d, K):
    """Return the map of (x, u) from a sample to the next."""
    own, before, new = parts(A, B, h, d)
    return np.block([[own + new @ K, before], [K, np.zeros((len(K), len(K)))]])
