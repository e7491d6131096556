"""The other side of a decay rate: what no proof can exceed (floating point, for the reader)."""

from __future__ import annotations

from contextlib import suppress
from math import isfinite

from numpy.linalg import LinAlgError

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.branches import best_words
from nrs_design.search.decay import limit_rate
from nrs_design.search.family import to_floats
from nrs_design.search.step_graph import StepGraph
from nrs_design.work import Allowance

# Work for the words that are looked at.
WORK = 0.5


def rate_limit(system: SwitchedSystem) -> float | None:
    """Return a rate that solutions cannot beat, because one of them attains it.

    Modes that must be left are left out of account; None if all are, or if modes take turns.
    Continuous time: the slowest mode's ``-max Re``, in 1/s. Discrete time: the largest
    ``radius(A_k ... A_1)^(1/k)`` over short products of modes, a lower bound of the joint spectral
    radius; where switching is constrained, of single modes only.
    """
    modes = system.lasting_modes()
    if not modes:
        return None
    if system.is_uniform:
        families = [to_floats([mode.A for mode in modes])]
    else:
        families = [to_floats([mode.A]) for mode in modes]
    limits = [limit_rate(matrices, system.time) for matrices in families]
    if not all(map(isfinite, limits)):
        return None
    if system.time is Time.CONTINUOUS:
        return min(limits)
    if system.switching.is_arbitrary:
        graph = StepGraph.free([mode.name for mode in modes], families[0])
        with suppress(LinAlgError):
            limits += (growth for _, growth in best_words(graph, Allowance(WORK), max(limits)))
    limit = max(limits)
    return limit if isfinite(limit) else None
