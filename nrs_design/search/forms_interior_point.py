"""An interior-point method for quadratic forms on a graph, which knows how they enter (untrusted).

A general solver is given the inequality of an edge as that many linear equations as it has
entries, and factors them all. Here the matrices of the second derivative are sums of Kronecker
products, which one multiplication of matrices makes for all edges of a kind at once, and what is
left to solve are the equations of the forms alone. For 15 states and some sixty edges that takes a
twentieth of the time.

The forms have a fixed trace, so the margin has a sign: where it is negative, the forms are those
that come nearest. Directions as in `nrs_design.search.interior_point`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from nrs_design.search.interior_point import follow, nesterov_todd, predict_and_correct
from nrs_design.search.sdp import pack, symmetric_basis, unpack
from nrs_design.work import Cost

Array = NDArray[np.float64]

# The margin is found to this share of itself, or to this share of the forms where it is nil.
ACCURACY, FLOOR = 0.5, 1e-11
# The equations of the optimum hold nearly enough for its bound to be believed.
NEARLY_DUAL = 1e-6
# The start lies below the margin of its forms by at least this, and its multipliers are these.
START_FLOOR, START_MULTIPLIER = 1e-3, 0.1
# What was found for other numbers starts so many of its margins below.
WARM = 100.0
# Work per step, per cone of a step, and per multiplication; bytes per entry of a cone.
PER_STEP, PER_CONE, PER_PRODUCT = 5e-4, 1.5e-4, 1e-10
BYTES_PER_ENTRY = 400


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

    constant: float
    terms: tuple[FormTerm, ...]
    multipliers: tuple[tuple[int, Array], ...]  # Which m, and C of shape (cones, s, s)
    counts: bool
    cones: int
    size: int


@dataclass(frozen=True)
class FormsPoint:
    """Forms and multipliers, with the margin that they leave."""

    forms: list[Array]
    multipliers: Array
    margin: float  # Negative if some inequality does not hold


class FormsCones:
    """The inequalities of a program, and the operations that a step needs."""

    def __init__(self, sizes: Sequence[int], multipliers: int, kinds: Sequence[ConeKind]) -> None:
        self.sizes, self.kinds = list(sizes), list(kinds)
        self.ends = np.cumsum([n * (n + 1) // 2 for n in sizes])
        self.unknowns = int(self.ends[-1]) + multipliers + 1
        # The sum of all traces.
        self.trace = np.zeros(self.unknowns)
        self.trace[: self.ends[-1]] = np.concatenate([pack(np.eye(n)) for n in sizes])

    def cost(self) -> Cost:
        """Predict what one step takes."""
        products = self.unknowns**3 / 3
        for kind in self.kinds:
            products += sum(
                kind.cones * (self.sizes[p.form] * self.sizes[q.form]) ** 2
                for p in kind.terms
                for q in kind.terms
            )
        cones = sum(kind.cones * kind.size**2 / 200 for kind in self.kinds)
        entries = sum(kind.cones * kind.size**2 for kind in self.kinds)
        return Cost(PER_STEP + PER_CONE * cones + PER_PRODUCT * products, BYTES_PER_ENTRY * entries)

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
                X += (term.L @ forms[term.form]) @ _t(term.R)
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
                forms[term.form] += (_t(term.L) @ Z @ term.R).sum(axis=0)
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
                    K = _kronecker(_t(p.R) @ S @ q.L, _t(q.R) @ S @ p.L)
                    place = p.form, q.form
                    # The pair the other way round gives the transpose.
                    own = 2 * K if p.form == q.form and p is not q else K
                    pairs[place] = pairs[place] + own if place in pairs else own
            scalars = list(self._scalars(kind, S))
            for i, moved, _ in scalars:
                for p in kind.terms:
                    a, F = starts[p.form], (_t(p.L) @ moved @ p.R).sum(axis=0)
                    own = pack((F + F.T) / 2)
                    H[a : a + len(own), i] += own
                    H[i, a : a + len(own)] += own
                for k, _, other in scalars:
                    H[i, k] += float((moved * other).sum())
        for (first, second), K in pairs.items():
            rows, columns = _spread(self.sizes[first]), _spread(self.sizes[second])
            block, a, b = rows.T @ K @ columns, starts[first], starts[second]
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


def maximize(
    cones: FormsCones,
    start: FormsPoint | None,
    goes_on: Callable[[], bool] = lambda: True,
    accuracy: float = ACCURACY,
) -> FormsPoint:
    """Maximize the margin, to a share of itself; end where it is found to be negative, too.

    It starts at positive definite forms and multipliers, else at the identity. `goes_on` is asked
    before every step; No ends the search with the last iterate.
    """
    y = _start(cones, start)
    inverse = [np.asarray(np.linalg.inv(own), dtype=np.float64) for own in cones.at(y)]
    counted = sum(
        float(np.trace(own, axis1=1, axis2=2).sum())
        for own, kind in zip(inverse, cones.kinds, strict=True)
        if kind.counts
    )

    def is_enough(value: float, gap: float, lacks: float) -> bool:
        nearly = gap <= max(FLOOR, accuracy * abs(value)) or value + 2 * gap < 0
        return lacks < NEARLY_DUAL and nearly

    Z = [own / counted for own in inverse]
    y = follow(y, Z, cones.at, partial(_step, cones), is_enough, goes_on)
    forms, multipliers = cones.split(y)
    return FormsPoint(forms, multipliers, float(y[-1]))


def _start(cones: FormsCones, start: FormsPoint | None) -> Array:
    count = cones.unknowns - int(cones.ends[-1]) - 1
    if start is None:
        forms = [np.eye(n) for n in cones.sizes]
        start = FormsPoint(forms, np.full(count, START_MULTIPLIER), 0.0)
    whole = sum(float(np.trace(Q)) for Q in start.forms)
    share = sum(cones.sizes) / whole
    packed = [pack(share * Q) for Q in start.forms]
    y = np.concatenate([*packed, share * start.multipliers, [0.0]])
    counting = [X for X, kind in zip(cones.at(y), cones.kinds, strict=True) if kind.counts]
    least = min(float(np.linalg.eigvalsh(X)[:, 0].min()) for X in counting)
    largest = max(float(np.abs(X).max()) for X in counting)
    below = max(0.1 * largest, START_FLOOR)
    y[-1] = least - (min(below, WARM * abs(start.margin)) if start.margin else below)
    return y


def _step(cones: FormsCones, X: list[Array], Z: list[Array]) -> tuple[Array, list[Array], float]:
    """Return the changes of y and Z, and by how much the equations of the optimum will fail."""
    scaled = [nesterov_todd(a, b) for a, b in zip(X, Z, strict=True)]
    W, d = [own[0] for own in scaled], [own[1] for own in scaled]
    residual = cones.adjoint(Z)
    residual[-1] += 1.0
    gram = np.zeros((cones.unknowns + 1, cones.unknowns + 1))
    gram[:-1, :-1] = cones.gram([_t(own) @ own for own in W])
    # The trace does not change; its unit is that of the other equations.
    size = float(np.sqrt(np.abs(gram.diagonal()[:-1]).max()))
    gram[-1, :-1] = gram[:-1, -1] = size * cones.trace

    def direction(target: list[Array]) -> tuple[Array, list[Array]]:
        moved = [_t(own) @ part @ own for own, part in zip(W, target, strict=True)]
        force = np.append(cones.adjoint(moved) + residual, 0.0)
        dy = np.asarray(np.linalg.solve(gram, force))[:-1]
        return dy, [own @ part @ _t(own) for own, part in zip(W, cones.image(dy), strict=True)]

    step = predict_and_correct(d, direction)
    # The equation of the trace makes up for a part of the residual.
    along = cones.trace * float(residual @ cones.trace) / float(cones.trace @ cones.trace)
    lacks = (1 - step.dual) * float(np.abs(residual - along).max())
    back = [step.dual * (_t(own) @ part @ own) for own, part in zip(W, step.dZ, strict=True)]
    return step.primal * step.dy, back, lacks


def _kronecker(U: Array, V: Array) -> Array:
    """Return the matrix of ``sum of trace(Q U P V)`` over pairs of entries of Q and P."""
    count, p, q = U.shape
    sums = U.reshape(count, -1).T @ V.reshape(len(V), -1)
    return np.asarray(sums.reshape(p, q, q, p).transpose(3, 0, 1, 2).reshape(p * p, q * q))


@cache
def _spread(n: int) -> Array:
    """Return the entries of a symmetric matrix of its packed coordinates; not to be written to."""
    basis = symmetric_basis(n).reshape(-1, n * n).T.copy()
    basis.setflags(write=False)
    return basis


def _t(A: Array) -> Array:
    return np.swapaxes(A, -1, -2)
