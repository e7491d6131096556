"""Upper bounds on norms of small symmetric matrices and forms that balls enclose."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import product
from typing import Any

import numpy as np

from nrs_design.robot.models.enclosure.balls import OUTWARD, TINY, Balls, Floats

# The norm of a 3 x 3 matrix is found up to the factor 3^(1/2^(n+1)) after n.
SQUARINGS = 11
# Of the many directions of a form, whose corners cost more than this does.
FEW_SQUARINGS = 7
NEGLIGIBLE = 2.0**-400
# Each edge of an octahedron is cut into so many.
CUTS = 6
# Boxes whose forms are looked at in all directions at once.
AT_ONCE = 256
# Share of what is enough that radii may take up.
ROOM = 0.5
Symmetric = Sequence[Sequence[Balls]]


def norm(A: Symmetric, squarings: int = SQUARINGS) -> Floats:
    """Return a number not below the norm of every symmetric matrix in the balls.

    The norm of A is the square root of that of ``A^2``, which is not above its trace.

    Parameters
    ----------
    A : balls, shape (3, 3)
        Of boxes; the two triangles hold the same.
    squarings : int
        The more, the nearer to the norm.
    """
    exact = [[Balls(entry.mid) for entry in row] for row in A]
    squares = sum(entry.rad**2 for row in A for entry in row)
    size = _norm(exact, squarings) + np.sqrt(squares * OUTWARD + TINY) * OUTWARD
    return np.asarray(size * OUTWARD)


def _norm(A: Symmetric, squarings: int) -> Floats:
    square = _squared(A)
    trace = (square[0][0] + square[1][1] + square[2][2]).magnitude
    if not squarings:
        return np.asarray(np.sqrt(trace) * OUTWARD)
    scale = Balls(np.where(trace > NEGLIGIBLE, trace, 1.0))
    inverse = scale.reciprocal()
    inner = _norm([[entry * inverse for entry in row] for row in square], squarings - 1)
    # Of what is all but zero the trace will do: one over it would leave the floats.
    size = np.where(trace <= NEGLIGIBLE, trace, scale.mid * inner)
    return np.asarray(np.sqrt(size * OUTWARD) * OUTWARD)


def _squared(A: Symmetric) -> list[list[Balls]]:
    upper = {
        (i, j): A[i][0] * A[0][j] + A[i][1] * A[1][j] + A[i][2] * A[2][j]
        for i in range(3)
        for j in range(i, 3)
    }
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def form_norm(forms: Sequence[Symmetric], enough: float = 0.0) -> Floats:
    """Return a number not below ``|(v'F_1 v, v'F_2 v, v'F_3 v)|`` of all unit vectors v.

    It is the largest norm of ``u_1 F_1 + u_2 F_2 + u_3 F_3`` over unit vectors u. That is convex in
    u, so the largest one at the corners of a body that holds all u is not below it.

    Parameters
    ----------
    forms : balls, shape (3, 3, 3)
        Three symmetric matrices for each of the boxes.
    enough : float
        Where a coarser bound is not above this, it is returned.
    """
    entries = [entry for F in forms for row in F for entry in row]
    sizes, radii = (
        np.sqrt(sum(part) * OUTWARD + TINY) * OUTWARD
        for part in ((e.magnitude**2 for e in entries), (e.rad**2 for e in entries))
    )
    bound = np.array(sizes, ndmin=1)
    # Where the radii alone are too much, smaller boxes are wanted and not a finer look.
    wide = radii > ROOM * enough if enough else np.zeros_like(radii, bool)
    fine = np.flatnonzero((bound > enough) & (bound < np.inf) & ~wide)
    for part in np.array_split(fine, len(fine) // AT_ONCE + 1):
        if len(part):
            bound[part] = np.minimum(bound[part], _form_norm(forms, part))
    return bound


def _form_norm(forms: Sequence[Symmetric], boxes: Any) -> Floats:
    u, inside = directions()
    shape = np.broadcast_shapes(*(np.shape(e.mid) for F in forms for row in F for e in row))

    def spread(entry: Balls) -> Balls:
        parts = (np.broadcast_to(part, shape)[boxes, None] for part in (entry.mid, entry.rad))
        return Balls(*parts)

    wide = [[[spread(entry) for entry in row] for row in F] for F in forms]
    mixed = [
        [sum((wide[c][i][j] * u[c] for c in range(3)), Balls(0.0)) for j in range(3)]
        for i in range(3)
    ]
    return np.asarray(norm(mixed, FEW_SQUARINGS).max(axis=-1) / inside * OUTWARD)


@cache
def directions() -> tuple[Floats, float]:
    """Return points on the sphere, and the radius of a ball within them and their opposites.

    Returns
    -------
    array, shape (3, k)
        One for each two opposite corners of the body.
    float
        The least distance of its faces from zero, rounded down.
    """
    grid = {
        (i, j): np.array([i, j, CUTS - abs(i) - abs(j)]) / CUTS
        for i, j in product(range(-CUTS, CUTS + 1), repeat=2)
        if abs(i) + abs(j) <= CUTS
    }
    points = {key: row / np.linalg.norm(row) for key, row in grid.items()}
    least = min(
        abs(np.dot(a, np.cross(b, c))) / np.linalg.norm(np.cross(b - a, c - a))
        for a, b, c in _faces(points)
    )
    return np.array(list(points.values())).T, float(least) * (1 - 1e-12)


def _faces(points: dict[tuple[int, int], Floats]) -> list[tuple[Floats, Floats, Floats]]:
    """Return the triangles of the upper half, cut as the faces of the octahedron are."""
    faces = []
    for sx, sy in product((1, -1), repeat=2):
        for i, j in product(range(CUTS), repeat=2):
            corners = [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)]
            a, b, c, d = (points.get((sx * m, sy * n)) for m, n in corners)
            if a is not None and b is not None and c is not None:
                faces.append((a, b, c))
            if b is not None and c is not None and d is not None:
                faces.append((b, c, d))
    return faces
