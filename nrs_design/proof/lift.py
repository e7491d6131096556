"""TRUSTED: symmetric lifts of a linear map, in plain Python integers.

For the vector ``z(x)`` of all monomials of degree d, ``x' = A x`` gives ``z' = A_d z`` and
``x+ = A x`` gives ``z+ = A^d z``. A form ``z' N z`` may vanish identically although N does not.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

IntegerMatrix = Sequence[Sequence[int]]
Monomial = tuple[int, ...]


@cache
def monomials(variables: int, degree: int) -> tuple[Monomial, ...]:
    """Return the exponents of all monomials of one degree, the first variable's highest first."""
    if variables == 1:
        return ((degree,),)
    return tuple(
        (first, *tail)
        for first in range(degree, -1, -1)
        for tail in monomials(variables - 1, degree - first)
    )


def derivative_lift(N: IntegerMatrix, degree: int) -> list[list[int]]:
    """Return the matrix of ``z' = A_d z`` over the same denominator as ``A = N / denominator``.

    By the product rule, ``d/dt x^a = sum_ij a_i A_ij x^(a - e_i + e_j)``.
    """
    n = len(N)
    basis = monomials(n, degree)
    index = {monomial: k for k, monomial in enumerate(basis)}
    matrix = [[0] * len(basis) for _ in basis]
    for k, monomial in enumerate(basis):
        for i in range(n):
            for j in range(n):
                if monomial[i] and N[i][j]:
                    matrix[k][index[_move(monomial, i, j)]] += monomial[i] * N[i][j]
    return matrix


def power_lift(N: IntegerMatrix, degree: int) -> list[list[int]]:
    """Return the matrix of ``z+ = A^d z`` over ``denominator^degree`` for ``A = N / denominator``.

    Row a holds the coefficients of ``prod_i ((A x)_i)^(a_i)``. The matrix need not be square.
    """
    n = len(N[0])
    index = {monomial: k for k, monomial in enumerate(monomials(n, degree))}
    lifted = []
    for monomial in monomials(len(N), degree):
        product: dict[Monomial, int] = {(0,) * n: 1}
        for i, exponent in enumerate(monomial):
            for _ in range(exponent):
                product = _times_linear(product, N[i])
        row = [0] * len(index)
        for term, coefficient in product.items():
            row[index[term]] = coefficient
        lifted.append(row)
    return lifted


def vanishes(N: IntegerMatrix, variables: int, degree: int) -> bool:
    """Decide whether ``z(x)' N z(x)`` is zero for all x, z the monomials of a degree."""
    basis = monomials(variables, degree)
    coefficients: dict[Monomial, int] = {}
    for a, row in zip(basis, N, strict=True):
        for b, entry in zip(basis, row, strict=True):
            term = tuple(p + q for p, q in zip(a, b, strict=True))
            coefficients[term] = coefficients.get(term, 0) + entry
    return not any(coefficients.values())


def _move(monomial: Monomial, i: int, j: int) -> Monomial:
    """Return the exponents with one x_i replaced by x_j."""
    exponents = list(monomial)
    exponents[i] -= 1
    exponents[j] += 1
    return tuple(exponents)


def _times_linear(product: dict[Monomial, int], row: Sequence[int]) -> dict[Monomial, int]:
    result: dict[Monomial, int] = {}
    for term, coefficient in product.items():
        for j, entry in enumerate(row):
            if entry:
                key = (*term[:j], term[j] + 1, *term[j + 1 :])
                result[key] = result.get(key, 0) + coefficient * entry
    return result
