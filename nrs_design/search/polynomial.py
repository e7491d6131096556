"""Degrees of forms, and costs of their programs.

Both are known before anything is lifted.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import comb, factorial, prod

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence.graph import MAX_DEGREE, MAX_MONOMIALS
from nrs_design.proof.lift import monomials
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.drawing import SAMPLES
from nrs_design.search.sdp import pack, program_cost, unpack
from nrs_design.search.work import Cost

SIZE_LIMITS = f"a certificate holds at most {MAX_MONOMIALS} monomials and degree {MAX_DEGREE}"
# Work of checking that a form is positive in exact arithmetic, per entry of its matrix.
PER_CHECK = 6e-5
Array = NDArray[np.float64]
Exponents = NDArray[np.int64]
Pair = tuple[int, int]


def highest_degree(variables: int) -> int:
    """Return the largest d whose monomials a certificate can hold."""
    degrees = range(1, MAX_DEGREE // 2 + 1)
    fitting = (d for d in degrees if comb(variables + d - 1, d) <= MAX_MONOMIALS)
    return max(fitting, default=1)


def rising_degrees(variables: int, highest: float) -> Iterator[int]:
    """Yield halves of degrees to try, up to a highest one.

    Each degree takes about four times the one before, so all lower ones together take a part of
    the cost of the last one.
    """
    last, d = min(highest_degree(variables), highest), 2
    while d < last:
        yield d
        d += max(1, d // 3)
    if last >= 2:
        yield int(last)


def conewise_cost(system: SwitchedSystem, degree: int) -> tuple[Cost, str]:
    """Predict what a form of degree 2d in contact and free motion takes; say for what."""
    return family_cost(system, degree, len(system.free))


def family_cost(system: SwitchedSystem, degree: int, free: int = 0) -> tuple[Cost, str]:
    """Predict the cost of a form of degree 2d for all modes, and some of free motion."""
    n, modes = system.order, len(system.modes)
    (order, own, forms), (inner, _, flying) = (form_sizes(k, degree) for k in (n, n - 1))
    shared_unknowns = own + 1
    cones = [(order, shared_unknowns)] * 2 + [(order, shared_unknowns + forms)] * modes
    cones += [(inner, shared_unknowns + flying)] * free
    unknowns = shared_unknowns + modes * forms + free * flying
    return program_cost(unknowns, shared_unknowns, cones), f"a program in {order} monomials"


def form_sizes(variables: int, degree: int) -> tuple[int, int, int]:
    """Return the numbers of monomials, of forms of them, and of forms that vanish."""
    order = comb(variables + degree - 1, degree)
    entries = order * (order + 1) // 2
    return order, entries, entries - comb(variables + 2 * degree - 1, 2 * degree)


def functions_cost(system: SwitchedSystem, degree: int) -> tuple[Cost, str]:
    """Predict the cost of a form of degree 2d for each mode, with its name."""
    order = max(mode.A.shape[0] for mode in system.modes)
    return graph_cost(order, degree, len(system.modes), _count_decreases(system))


def graph_cost(variables: int, degree: int, nodes: int, edges: int) -> tuple[Cost, str]:
    """Predict what forms of degree 2d take; say for what."""
    order, own, forms = form_sizes(variables, degree)
    shared_unknowns, cones = own * nodes + 1, [(order, own)] * (2 * nodes)
    cones += [(order, 2 * own + forms)] * edges
    description = f"a program with {len(cones)} blocks of order {order}"
    return program_cost(shared_unknowns + forms * edges, shared_unknowns, cones), description


def work_of_checks(system: SwitchedSystem, degree: int) -> float:
    """Predict the work of checking what is found, by us and by the second library."""
    order, *_ = form_sizes(max(mode.A.shape[0] for mode in system.modes), degree)
    return 2 * _count_decreases(system) * PER_CHECK * order**2


def _count_decreases(system: SwitchedSystem) -> int:
    """Return the number of inequalities of a form for each mode."""
    counts = {name: _count_stays(system, stay) for name, stay in system.stays().items()}
    return len(system.modes) + sum(counts[edge.source.name] for edge in system.edges())


def _count_stays(system: SwitchedSystem, stay: Stay) -> int:
    if stay.longest is None:
        return 1
    if system.time is Time.CONTINUOUS:
        return SAMPLES
    return int(stay.longest) - int(stay.shortest) + 1


def products(variables: int, degree: int) -> list[list[Pair]]:
    """Group the pairs of monomials by their product; diagonal pairs first in their group."""
    basis = monomials(variables, degree)
    groups: dict[tuple[int, ...], list[Pair]] = {}
    for i, a in enumerate(basis):
        for j in range(i, len(basis)):
            key = tuple(p + q for p, q in zip(a, basis[j], strict=True))
            groups.setdefault(key, []).append((i, j))
    return [sorted(group, key=lambda pair: pair[0] != pair[1]) for group in groups.values()]


def monomial_weights(variables: int, degree: int) -> Exponents:
    """Return the logarithms of powers of two near ``sqrt(multinomial)``."""
    counts = [factorial(degree) / prod(map(factorial, a)) for a in monomials(variables, degree)]
    return np.asarray(np.rint(np.log2(counts) / 2).astype(np.int64))


def vanishing_basis(variables: int, degree: int, scaling: Exponents) -> Array:
    """Return an orthonormal basis of the forms that vanish, in the coordinates ``2^e z(x)``.

    z are the monomials of a degree in so many variables, e the exponents of the scaling.
    """
    groups, size = products(variables, degree), len(scaling)
    forms = [_difference(group[0], other, scaling) for group in groups for other in group[1:]]
    if not forms:
        return np.zeros((0, size, size))
    return unpack(np.linalg.qr(pack(np.array(forms)).T)[0].T, size)


def _difference(first_pair: Pair, second_pair: Pair, scaling: Exponents) -> Array:
    """Return the form ``z_i z_j - z_k z_l`` of two pairs with the same product, scaled."""
    form = np.zeros((len(scaling), len(scaling)))
    for (i, j), sign in ((first_pair, 1.0), (second_pair, -1.0)):
        form[i, j] += sign / 2
        form[j, i] += sign / 2
    return np.asarray(np.ldexp(form, -scaling[:, None] - scaling[None, :]))


def make_vanish(N: list[list[int]], groups: list[list[Pair]]) -> list[list[int]]:
    """Correct one entry for each product of monomials so that ``z' N z`` vanishes exactly."""
    for group in groups:
        total = sum(N[i][j] * (1 if i == j else 2) for i, j in group)
        i, j = group[0]
        # Without a diagonal pair in the group, the total is even.
        N[i][j] -= total if i == j else total // 2
        N[j][i] = N[i][j]
    return N
