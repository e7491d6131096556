"""Search for a growing word in discrete time, where any mode may follow any at every step."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MAX_WORDS = 20_000
MAX_WORD_LENGTH = 16


def growing_words(matrices: Array) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield for each length the word with the largest spectral radius.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        The modes.

    Yields
    ------
    tuple
        The modes of the word in order, and its spectral radius.
    """
    m, length = len(matrices), 1
    while length < MAX_WORD_LENGTH and m ** (length + 1) <= MAX_WORDS:
        length += 1
        words = np.array(list(product(range(m), repeat=length)))
        monodromy = matrices[words[:, 0]]
        for column in words.T[1:]:
            monodromy = matrices[column] @ monodromy
        radius = np.abs(np.linalg.eigvals(monodromy)).max(axis=1)
        best = int(radius.argmax())
        yield tuple(int(i) for i in words[best]), float(radius[best])
