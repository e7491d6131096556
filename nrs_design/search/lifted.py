"""Forms in monomials of one degree that vanish identically, in floating point."""

from __future__ import annotations

from math import factorial, prod

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.lift import monomials
from nrs_design.search.sdp import pack, unpack

Array = NDArray[np.float64]
Exponents = NDArray[np.int64]
Pair = tuple[int, int]


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


def _difference(one: Pair, other: Pair, scaling: Exponents) -> Array:
    """Return the form ``z_i z_j - z_k z_l`` of two pairs with the same product, scaled."""
    form = np.zeros((len(scaling), len(scaling)))
    for (i, j), sign in ((one, 1.0), (other, -1.0)):
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
