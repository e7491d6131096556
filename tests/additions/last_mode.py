"""A graph of another shape: one form for each mode that was in force at the step before.

It is added to a copy of the package, as ``search/last_mode.py``.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
from scipy.linalg import solve_discrete_lyapunov

from nrs_design.proof.evidence.graph import MODES, Arc, FormsOnGraph, Node
from nrs_design.search.acceptance import Candidate, Candidates
from nrs_design.search.family import Family
from nrs_design.search.rates import unscale

BITS = 30


def search_last_mode(family: Family) -> Candidates[FormsOnGraph]:
    """Yield the sum of the modes' own functions, once for each mode that may have come before."""
    n = family.matrices.shape[-1]
    own = [solve_discrete_lyapunov(A.T, np.eye(n)) for A in family.matrices]
    form, log2 = unscale(np.sum(own, axis=0), family.exponents, BITS)
    modes = [mode.name for mode in family.system.modes]
    nodes = tuple(Node(MODES, form) for _ in modes)
    edges = tuple(Arc(None, mode, k) for k, mode in enumerate(modes))
    yield Candidate(FormsOnGraph(nodes, log2, Fraction(99, 100), edges=edges), "drawn")
    return None
