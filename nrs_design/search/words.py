"""Search for a growing word in discrete time, where any mode may follow any at every step."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nrs_design.work import Allowance, Cost

Array = NDArray[np.float64]

MAX_WORDS = 20_000
MAX_WORD_LENGTH = 16
# Work for the eigenvalues of a matrix, and per multiplication in them.
PER_MATRIX = 5e-6
PER_PRODUCT = 3e-8


def growing_words(matrices: Array, allowance: Allowance) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield for each length the word with the largest spectral radius, and that.

    Words of a length for which work or memory do not suffice end the search.
    """
    m, length = len(matrices), 1
    while length < MAX_WORD_LENGTH and m ** (length + 1) <= MAX_WORDS:
        length += 1
        count, n = m**length, matrices.shape[1]
        cost = Cost(count * (PER_MATRIX + PER_PRODUCT * n**3), 32 * count * n**2)
        allowance.take(cost, f"looking at {count} products of {length} modes")
        words, monodromy = products_of(matrices, length)
        radius = np.abs(np.linalg.eigvals(monodromy)).max(axis=1)
        best = int(radius.argmax())
        yield tuple(int(i) for i in words[best]), float(radius[best])


def products_of(matrices: Array, length: int) -> tuple[NDArray[np.int64], Array]:
    """Return all words of a length, shape (count, length), with their products."""
    words = np.array(list(product(range(len(matrices)), repeat=length)))
    found = matrices[words[:, 0]]
    for column in words.T[1:]:
        found = matrices[column] @ found
    return words, found
