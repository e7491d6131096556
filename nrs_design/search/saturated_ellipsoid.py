"""Search for ellipsoids in which motions decay although signals saturate, by CVXPY (untrusted).

With ``S = Q^-1`` and ``Y = H S`` the conditions of `nrs_design.proof.evidence.saturated_ellipsoid`
in contact are linear in S and Y (Hu and Lin), and the largest start is found at once. Free motion
is about a block of Q. There is ``y' M y < 0`` on a block if and only if ``(B + g e')' Q + Q (B + g
e') < 0`` for some column g, e the unit vector of the deflection; for a fixed g that is linear in S.
So g is taken from the last S, beginning where nothing saturates, and S is improved until that
gains little. At last H is rounded, and Q is found for it with as much to spare as possible.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import SaturatedEllipsoid
from nrs_design.proof.system import SwitchedSystem, Time
from nrs_design.search.allowance import Allowance, Cost
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.family import Family, to_floats
from nrs_design.search.raw import LOADING, PER_PROGRAM
from nrs_design.search.rounding import round_rate, unscale

Array = NDArray[np.float64]

DIGITS = (16, 20, 24, 32, 40, 50, 60)
H_DIGITS = 40
# The slowest decay that counts, as a share of the fastest there is, and by how much a start stays
# below the largest one: nearer to it there is no decay to speak of.
SLOWEST, BELOW = 1e-3, 0.99
# Improvements of a region in free motion, and the least gain that is worth another.
STEPS, GAIN = 12, 1.003
BISECTIONS = 6
# A start just inside of a region leaves nothing for rounding.
ENOUGH = 0.999
# Shares of the largest rate that are claimed.
RATES = (0.99, 0.9, 0.5, 0.1)
# In coordinates in which nothing saturates in the unit ball.
SMALLEST, LARGEST = 1e-7, 1e5


@dataclass(frozen=True)
class Problem:
    """The loop in floating point; signals in units of their limits.

    Parameters
    ----------
    A : ndarray, shape (k, n, n)
        Modes in contact, and after them the free ones, which leave the deflection where it is.
    free : int
        How many of them are free.
    columns : ndarray, shape (k, s, n)
        What every signal does.
    rows : tuple of ndarray, each of shape (k, n + signals before)
        Their arguments.
    starts : ndarray, shape (c, n)
        States at the size one.
    """

    A: Array
    free: int
    columns: Array
    rows: tuple[Array, ...]
    starts: Array

    @classmethod
    def of(cls, system: SwitchedSystem) -> Problem:
        """Convert a system of which something saturates."""
        saturation = system.saturation
        assert saturation is not None  # who asks has looked
        free = () if system.contact is None else system.contact.free
        limits = np.array([float(s.limit) for s in saturation.signals])
        A = to_floats([mode.A for mode in (*system.modes, *free)])
        columns = np.stack([to_floats(s.columns)[:, :, 0] for s in saturation.signals], axis=1)
        columns *= limits[:, None]
        if free:
            A[-len(free) :, -1] = columns[-len(free) :, :, -1] = 0.0
        n, rows = A.shape[1], list[Array]()
        for i, signal in enumerate(saturation.signals):
            row = to_floats(signal.rows)[:, 0] / limits[i]
            row[:, n:] *= limits[:i]
            rows.append(row)
        starts = to_floats(saturation.start.states)[:, :, 0]
        return cls(A, len(free), columns, tuple(rows), starts)

    def transformed(self, T: Array) -> Problem:
        """Return the same in coordinates ``x = T z``."""
        inverse, n = np.linalg.inv(T), len(T)
        rows = (np.concatenate([row[:, :n] @ T, row[:, n:]], axis=1) for row in self.rows)
        return replace(
            self,
            A=inverse @ self.A @ T,
            columns=self.columns @ inverse.T,
            rows=tuple(rows),
            starts=self.starts @ inverse.T,
        )

    @property
    def linear(self) -> Array:
        """The signals while nothing is cut off, as rows; shape (k, s, n)."""
        found: list[Array] = []
        n = self.A.shape[1]
        for row in self.rows:
            whole = row[:, :n].copy()
            for i, before in enumerate(found):
                whole += row[:, n + i, None] * before
            found.append(whole)
        return np.stack(found, axis=1)

    def vertices(self, S: Any, Y: Sequence[Any]) -> Iterator[tuple[int, Any]]:
        """Yield, with the index of its mode, ``B S`` for every B that a mode is a mixture of.

        Parameters
        ----------
        S : ndarray or expression, shape (n, n)
            The identity gives the matrices themselves.
        Y : sequence of ndarray or expression, each of shape (1, n)
            The rows ``h S``.
        """
        n, linear = self.A.shape[1], self.linear
        for k, replaced in product(range(len(self.A)), product((False, True), repeat=len(Y))):
            B, taken = self.A[k] @ S, list[Any]()
            for i, (row, y, other) in enumerate(zip(self.rows, Y, replaced, strict=True)):
                argument = row[k, None, :n] @ S
                for share, before in zip(row[k, n:], taken, strict=True):
                    argument = argument + share * before
                taken.append(y if other else argument)
                B = B + self.columns[k, i, :, None] @ (taken[-1] - linear[k, i, None] @ S)
            yield k, B

    def is_free(self, k: int) -> bool:
        """Tell whether a mode is one of free motion."""
        return k >= len(self.A) - self.free


@dataclass(frozen=True)
class Region:
    """The ellipsoid ``z' S^-1 z <= 1``, with its H, and the largest start in it."""

    S: Array
    H: Array
    size: float


def search_saturated(
    system: SwitchedSystem, allowance: Allowance
) -> Candidates[SaturatedEllipsoid]:
    """Yield ellipsoids that hold a start, those with the fastest decay first.

    The start is the wanted one; without one, or where it is out of reach, nearly the largest.

    Parameters
    ----------
    system : SwitchedSystem
        Stable, in continuous time, with what saturates.
    allowance : Allowance
        Time and memory.

    Raises
    ------
    NotAffordableError
        If time or memory do not suffice.
    """
    assert system.saturation is not None  # who asks has looked
    allowance.take(Cost(LOADING), "loading CVXPY")
    family, raw = Family.of(system), Problem.of(system)
    slowest = SLOWEST * family.limit
    T = np.diag(np.ldexp(1.0, family.exponents))
    first = _unsaturated(raw.transformed(T), slowest, allowance)
    if first is None:
        return NO_MARGIN
    # A triangular change of coordinates leaves the deflection alone, which is zero in free motion.
    T = T @ _triangular(first)
    T /= np.linalg.norm(raw.linear @ T, axis=-1).max()
    own = raw.transformed(T)
    if not all(np.isfinite(part).all() for part in (T, own.A, own.columns, *own.rows)):
        return OUT_OF_RANGE
    start = Region(np.eye(len(T)), own.linear[0], 0.0)
    largest = _largest(own, slowest, start, allowance)
    if largest is None:
        return NO_MARGIN
    level = Fraction(f"{BELOW * largest.size:.4e}")
    if (wanted := system.saturation.start.wanted) is not None and wanted < level:
        level = wanted
    region, rate = _fastest(own, largest, float(level), slowest, family.limit, allowance)
    yield from map(Candidate, _rounded(raw, system, T, region, rate, level, allowance))
    return None


def _unsaturated(problem: Problem, rate: float, allowance: Allowance) -> Array | None:
    """Return a quadratic function of the loop in which nothing is cut off."""
    cp, n = _cvxpy(), problem.A.shape[1]
    Q, t = cp.Variable((n, n), symmetric=True), cp.Variable()
    conditions = [Q << np.eye(n), Q >> t * np.eye(n)]
    for k, A in enumerate(problem.A):
        last = n - problem.is_free(k)
        part, own = Q[:last, :last], A[:last, :last]
        form = own.T @ part + part @ own + 2 * rate * part
        conditions.append(form << -t * np.eye(last))
    if not _solved(cp, cp.Problem(cp.Maximize(t), conditions), allowance) or not t.value > 0:
        return None
    return np.asarray(Q.value)


def _largest(
    problem: Problem, rate: float, start: Region, allowance: Allowance, enough: float = np.inf
) -> Region | None:
    """Return the region with the largest start; in free motion, one that is hard to improve."""
    best = None
    for _ in range(STEPS if problem.free else 1):
        found = _improved(problem, rate, start, allowance)
        if found is None or (best is not None and found.size < GAIN * best.size):
            return best if found is None or (best and best.size > found.size) else found
        best = start = found
        if best.size >= enough:
            break
    return best


def _improved(problem: Problem, rate: float, near: Region, allowance: Allowance) -> Region | None:
    """Return the largest region for the columns g that fit another."""
    cp, n, s = _cvxpy(), problem.A.shape[1], len(problem.rows)
    S, size = cp.Variable((n, n), symmetric=True), cp.Variable()
    Y = [cp.Variable((1, n)) for _ in range(s)]
    unit = np.linalg.norm(problem.starts, axis=1).max()
    # An ellipsoid may be long, but not without end.
    conditions = [S << LARGEST * np.eye(n)]
    conditions += [S >> size * np.outer(x, x) for x in problem.starts / unit]
    conditions += [cp.bmat([[np.eye(1), y], [y.T, S]]) >> 0 for y in Y]
    before = dict(enumerate(problem.vertices(np.eye(n), [h[None] for h in near.H])))
    for i, (k, B) in enumerate(problem.vertices(S, Y)):
        form = B
        if problem.is_free(k):
            g = _column(before[i][1], near.S, rate)
            form = B + g[:, None] @ S[n - 1 : n, :]
        conditions.append(form + form.T + 2 * rate * S << -SMALLEST * np.eye(n))
    program = cp.Problem(cp.Maximize(size), conditions)
    if not _solved(cp, program, allowance) or not size.value > 0:
        return None
    found = np.asarray(S.value)
    H = np.concatenate([np.asarray(y.value) for y in Y]) @ np.linalg.inv(found)
    return Region(found, H, float(np.sqrt(size.value) / unit))


def _column(B: Array, S: Array, rate: float) -> Array:
    """Return the g for which free motion, at its B, decreases in all states at once."""
    Q = np.linalg.inv(S)
    M = -(B.T @ Q + Q @ B + 2 * rate * Q)
    r = M[-1].copy()
    r[-1] = (M[-1, -1] - np.abs(np.diag(M)[:-1]).max()) / 2
    return np.asarray(S @ r)


def _fastest(
    problem: Problem,
    region: Region,
    level: float,
    slowest: float,
    fastest: float,
    allowance: Allowance,
) -> tuple[Region, float]:
    """Return a region that holds the start, with the largest rate that bisection finds."""
    low, high = slowest, fastest
    for _ in range(BISECTIONS):
        rate = float(np.sqrt(low * high))
        found = _largest(problem, rate, region, allowance, level / ENOUGH)
        if found is None or found.size * ENOUGH < level:
            high = rate
        else:
            region, low = found, rate
    return region, low


def _rounded(
    raw: Problem,
    system: SwitchedSystem,
    T: Array,
    region: Region,
    rate: float,
    level: Fraction,
    allowance: Allowance,
) -> Iterator[SaturatedEllipsoid]:
    """Yield the region with H rounded and Q found anew for it, with ever more digits."""
    assert system.saturation is not None
    limits = np.array([float(s.limit) for s in system.saturation.signals])
    H = limits[:, None] * (region.H @ np.linalg.inv(T))
    T = np.asarray(T @ _triangular(np.linalg.inv(region.S)), dtype=np.float64)
    log2 = max(0, H_DIGITS - int(np.frexp(np.abs(H).max())[1]))
    rows = tuple(tuple(round(float(v)) for v in row) for row in np.ldexp(H, log2))
    kept = np.ldexp(np.array(rows, dtype=float), -log2) / limits[:, None] @ T
    for share in RATES:
        alpha = round_rate(share * rate, Time.CONTINUOUS)
        own = _fitted(raw.transformed(T), kept, float(level), float(alpha), allowance)
        if own is None:
            continue
        inverse = np.linalg.inv(T)
        Q = inverse.T @ own @ inverse
        # In these units the diagonal of Q is about one.
        shifts = -np.round(np.log2(np.diag(Q)) / 2).astype(np.int64)
        unit = np.ldexp(np.ldexp(Q, shifts[:, None]), shifts[None])
        for bits in DIGITS:
            numerators, power = unscale(unit, shifts, bits)
            if power < 0:
                numerators = tuple(tuple(v << -power for v in row) for row in numerators)
            yield SaturatedEllipsoid(numerators, max(power, 0), alpha, rows, log2, level)


def _fitted(
    problem: Problem, H: Array, level: float, rate: float, allowance: Allowance
) -> Array | None:
    """Return Q for a given H, where it is about the identity, with as much to spare as possible."""
    cp, n = _cvxpy(), problem.A.shape[1]
    Q, t, e = cp.Variable((n, n), symmetric=True), cp.Variable(), np.eye(n + 1)
    conditions = [cp.bmat([[Q, h[:, None]], [h[None], np.eye(1)]]) >> t * e for h in H]
    conditions += [1 - level**2 * cp.quad_form(x, Q) >= t for x in problem.starts]
    for k, B in problem.vertices(np.eye(n), [h[None] for h in H]):
        last = n - problem.is_free(k)
        part, own = Q[:last, :last], B[:last, :last]
        form = own.T @ part + part @ own + 2 * rate * part
        conditions.append(form << -t * np.eye(last))
    if not _solved(cp, cp.Problem(cp.Maximize(t), conditions), allowance) or not t.value > 0:
        return None
    return np.asarray(Q.value)


def _triangular(Q: Any) -> Array:
    """Return an upper triangular T with ``T' Q T = I``."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(Q).T))


def _cvxpy() -> Any:
    import cvxpy

    return cvxpy


def _solved(cp: Any, program: Any, allowance: Allowance) -> bool:
    """Solve a program; tell whether there are numbers, whatever the solver says of them."""
    allowance.take(Cost(PER_PROGRAM), "a program for CVXPY")
    try:
        with warnings.catch_warnings(action="ignore"):
            program.solve(solver=cp.CLARABEL, max_threads=1, time_limit=allowance.left)
    except cp.SolverError:
        return False
    values = [variable.value for variable in program.variables()]
    return all(value is not None and np.isfinite(value).all() for value in values)
