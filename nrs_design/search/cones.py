"""The linear matrix inequalities of forms on a graph, stated once for all solvers (untrusted).

For every inequality X of a drawing: maximize t such that ``X >= t I`` where the margin counts, with
positive definite forms and multipliers between 0 and their largest value. Inequalities in which the
same forms enter are of one kind, and are made together.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from nrs_design.search.sdp import Sparse, pack, program_cost, triangle, unpack
from nrs_design.work import Cost

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# A multiplier of a crossing lies between 0 and this, where all numbers are of like size.
LARGEST_MULTIPLIER = 64.0
# Work per step of our own method, per cone of a step, per multiplication, and per entry of the
# largest Kronecker product; bytes per entry of a cone, and of that product.
PER_STEP, PER_CONE, PER_PRODUCT, PER_PAIR = 5e-4, 1.5e-4, 1e-10, 5e-8
BYTES_PER_ENTRY, BYTES_PER_PAIR = 400, 40


@dataclass(frozen=True)
class FormTerm:
    """``L Q R'`` for every cone of a kind: with its transpose, if that is another term."""

    form: int  # Which Q
    L: Array  # Shape (cones, s, n), or (1, s, n) if it is the same for all
    R: Array


@dataclass(frozen=True)
class ConeKind:
    """Cones of one size in which the same forms and multipliers enter.

    ``X = constant I + sum of terms + sum of m C - t I`` must be positive definite; the last only
    where the margin counts.
    """

    terms: tuple[FormTerm, ...]
    multipliers: tuple[tuple[int, Array], ...]  # Which m, and C of shape (cones, s, s)
    counts: bool
    cones: int
    size: int
    constant: float = 0.0


class FormsCones:
    """The inequalities of some forms and multipliers, and the operations that solvers need.

    `free` are numbers of any sign, behind the multipliers, that enter one inequality each.
    """

    def __init__(
        self, sizes: Sequence[int], multipliers: int, kinds: Sequence[ConeKind], free: int = 0
    ) -> None:
        self.sizes, self.multipliers, self.free = list(sizes), multipliers, free
        self.edges = list(kinds)
        self.ends = np.cumsum([n * (n + 1) // 2 for n in sizes])
        self.unknowns = int(self.ends[-1]) + multipliers + free + 1
        # The sum of all traces.
        self.trace = np.zeros(self.unknowns)
        self.trace[: self.ends[-1]] = np.concatenate([pack(np.eye(n)) for n in sizes])

    @cached_property
    def kinds(self) -> list[ConeKind]:
        """All of them, and before them the bounds of forms and multipliers."""
        found, one = list[ConeKind](), np.ones((1, 1, 1))
        for k, n in enumerate(self.sizes):
            whole = np.eye(n)[None]
            found.append(ConeKind((FormTerm(k, whole, whole),), (), False, 1, n))
        for k in range(self.multipliers):
            found.append(ConeKind((), ((k, one),), False, 1, 1))
            found.append(ConeKind((), ((k, -one),), False, 1, 1, LARGEST_MULTIPLIER))
        return [*found, *self.edges]

    @cached_property
    def bounded(self) -> list[ConeKind]:
        """The same with forms up to the identity, and a margin of their own, instead of a trace."""
        found = list[ConeKind]()
        for k, n in enumerate(self.sizes):
            whole = np.eye(n)[None]
            found.append(ConeKind((FormTerm(k, whole, whole),), (), True, 1, n))
            found.append(ConeKind((FormTerm(k, whole, -whole),), (), False, 1, n, 1.0))
        return [*found, *self.kinds[len(self.sizes) :]]

    def cost_of_solver(self) -> tuple[Cost, str]:
        """Predict what a general solver takes; say for what."""
        own = [n * (n + 1) // 2 for n in self.sizes]
        cones = []
        for kind in self.bounded:
            if kind.terms:
                touched = sum(own[form] for form in {term.form for term in kind.terms})
                touched += sum(k >= self.multipliers for k, _ in kind.multipliers)
                cones += [(kind.size, touched)] * kind.cones
        shared = self.unknowns - self.free
        return program_cost(self.unknowns, shared, cones), f"a program with {len(cones)} blocks"

    def for_solver(self) -> tuple[Sparse, Array, list[int]]:
        """Return rows, offset and sizes for a general solver; those of the edges are the last."""
        entries, offsets, sizes, first = list[tuple[Array, Indices, Indices]](), [], list[int](), 0
        starts = [0, *self.ends]
        for kind in self.bounded:
            for k in range(kind.cones):
                parts = [
                    (starts[term.form], _image(*(M[k % len(M)] for M in (term.L, term.R))))
                    for term in kind.terms
                ]
                parts += [(starts[-1] + m, pack(C[k])[:, None]) for m, C in kind.multipliers]
                if kind.counts:
                    parts.append((self.unknowns - 1, -pack(np.eye(kind.size))[:, None]))
                for start, image in parts:
                    i, j = np.nonzero(image)
                    entries.append((-image[i, j], first + i, start + j))
                offsets.append(kind.constant * pack(np.eye(kind.size)))
                sizes.append(kind.size)
                first += len(offsets[-1])
        values, rows, columns = (np.concatenate(part) for part in zip(*entries, strict=True))
        matrix = Sparse.of(values, rows, columns, (first, self.unknowns))
        return matrix, np.concatenate(offsets), sizes

    def cost(self) -> Cost:
        """Predict what one step of our own method takes."""
        products = self.unknowns**3 / 3
        for kind in self.kinds:
            products += sum(
                kind.cones * (self.sizes[p.form] * self.sizes[q.form]) ** 2
                for p in kind.terms
                for q in kind.terms
            )
        cones = sum(kind.cones * kind.size**2 / 200 for kind in self.kinds)
        entries = sum(kind.cones * kind.size**2 for kind in self.kinds)
        pairs = max(self.sizes) ** 4
        return Cost(
            PER_STEP + PER_CONE * cones + PER_PRODUCT * products + PER_PAIR * pairs,
            BYTES_PER_ENTRY * entries + BYTES_PER_PAIR * pairs,
        )

    def split(self, y: Array) -> tuple[list[Array], Array]:
        """Return forms and multipliers."""
        parts = np.split(y[:-1], self.ends)
        forms = [unpack(part, n) for part, n in zip(parts, self.sizes, strict=False)]
        return forms, parts[-1]

    def image(self, y: Array) -> list[Array]:
        """Return what unknowns make of the cones, but for constants."""
        forms, multipliers = self.split(y)
        images = []
        for kind in self.kinds:
            X = np.zeros((kind.cones, kind.size, kind.size))
            for term in kind.terms:
                X += (term.L @ forms[term.form]) @ transposed(term.R)
            for k, C in kind.multipliers:
                X += multipliers[k] * C
            if kind.counts:
                X -= y[-1] * np.eye(kind.size)
            images.append(X)
        return images

    def at(self, y: Array) -> list[Array]:
        """Return all X."""
        own = zip(self.image(y), self.kinds, strict=True)
        return [X + kind.constant * np.eye(kind.size) for X, kind in own]

    def adjoint(self, Zs: list[Array]) -> Array:
        """Return the product of every unknown's image with matrices."""
        forms = [np.zeros((n, n)) for n in self.sizes]
        rest = np.zeros(self.unknowns - int(self.ends[-1]))
        for kind, Z in zip(self.kinds, Zs, strict=True):
            for term in kind.terms:
                forms[term.form] += (transposed(term.L) @ Z @ term.R).sum(axis=0)
            for k, C in kind.multipliers:
                rest[k] += float((C * Z).sum())
            if kind.counts:
                rest[-1] -= float(np.trace(Z, axis1=1, axis2=2).sum())
        packed = [pack((F + F.T) / 2) for F in forms]
        return np.concatenate([*packed, rest])

    def gram(self, Ss: list[Array]) -> Array:
        """Return ``trace(A_k S A_l S)``, summed over all cones, with A_k the image of unknown k."""
        H = np.zeros((self.unknowns, self.unknowns))
        starts = [0, *self.ends[:-1]]
        pairs: dict[tuple[int, int], Array] = {}
        for kind, S in zip(self.kinds, Ss, strict=True):
            for i, p in enumerate(kind.terms):
                for q in kind.terms[i:]:
                    K = _kronecker(transposed(p.R) @ S @ q.L, transposed(q.R) @ S @ p.L)
                    place = p.form, q.form
                    # The pair the other way round gives the transpose.
                    own = 2 * K if p.form == q.form and p is not q else K
                    pairs[place] = pairs[place] + own if place in pairs else own
            scalars = list(self._scalars(kind, S))
            for i, moved, _ in scalars:
                for p in kind.terms:
                    a, F = starts[p.form], (transposed(p.L) @ moved @ p.R).sum(axis=0)
                    own = pack((F + F.T) / 2)
                    H[a : a + len(own), i] += own
                    H[i, a : a + len(own)] += own
                for k, _, other in scalars:
                    H[i, k] += float((moved * other).sum())
        for (first, second), K in pairs.items():
            block = _folded(_folded(K, self.sizes[first]).T, self.sizes[second]).T
            a, b = starts[first], starts[second]
            if first == second:
                H[a : a + len(block), a : a + len(block)] += (block + block.T) / 2
            else:
                H[a : a + len(block), b : b + block.shape[1]] += block
                H[b : b + block.shape[1], a : a + len(block)] += block.T
        return H

    def _scalars(self, kind: ConeKind, S: Array) -> Iterator[tuple[int, Array, Array]]:
        """Yield the unknowns that are numbers: their place, ``S C S`` and C."""
        for k, C in kind.multipliers:
            yield int(self.ends[-1]) + k, S @ C @ S, C
        if kind.counts:
            identity = np.broadcast_to(-np.eye(kind.size), S.shape)
            yield self.unknowns - 1, -(S @ S), identity


def _image(L: Array, R: Array) -> Array:
    """Return the packed entries that ``L Q R'`` adds to a symmetric matrix, by those of Q."""
    a, b = triangle(len(L))
    i, j = triangle(L.shape[1])
    both = L[a][:, i] * R[b][:, j] + L[a][:, j] * R[b][:, i]
    return np.asarray(np.where(a == b, 1.0, np.sqrt(2.0))[:, None] * both * _shares(L.shape[1]))


def _kronecker(U: Array, V: Array) -> Array:
    """Return the matrix of ``sum of trace(Q U P V)`` over pairs of entries of Q and P."""
    count, p, q = U.shape
    sums = U.reshape(count, -1).T @ V.reshape(len(V), -1)
    return np.asarray(sums.reshape(p, q, q, p).transpose(3, 0, 1, 2).reshape(p * p, q * q))


def _folded(K: Array, n: int) -> Array:
    """Return rows of the packed coordinates of a symmetric matrix from those of its entries."""
    (i, j), rows = triangle(n), K.reshape(n, n, -1)
    return np.asarray((rows[i, j] + rows[j, i]) * _shares(n)[:, None])


def _shares(n: int) -> Array:
    """Return what a packed coordinate adds to an entry and to its transpose, as one of both."""
    i, j = triangle(n)
    return np.where(i == j, 0.5, np.sqrt(0.5))


def transposed(A: Array) -> Array:
    """Return the transpose of every matrix of a stack."""
    return np.swapaxes(A, -1, -2)
