"""Search for a quadratic function that depends on parameters that are unknown but constant."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import ConstantsQuadratic
from nrs_design.proof.mode import Time
from nrs_design.search.acceptance import OUT_OF_RANGE, Candidates
from nrs_design.search.balance import mean_norm, round_coordinates, time_unit
from nrs_design.search.family import Family
from nrs_design.search.rates import Rates, digits, propose, round_form, round_matrix
from nrs_design.search.sdp import SemidefiniteProgram, packed_columns, symmetric_basis
from nrs_design.search.work import Allowance

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

NEAREST = 0.999
FEWEST_BITS = 8
# Relative resolution of the largest rate, and of any rate where none is requested.
RESOLUTION, COARSE = 2.0**-7, 0.5


def search_constants_quadratic(family: Family) -> Candidates[ConstantsQuadratic]:
    """Search for the function with the largest rate."""
    system = family.system
    if not np.isfinite(family.matrices).all() or not np.isfinite(family.limit):
        return OUT_OF_RANGE
    coordinates = round_coordinates(mean_norm(family.matrices, system.time))
    if not np.isfinite(coordinates).all():
        return OUT_OF_RANGE
    program = _Program.of(family, coordinates)
    resolution = RESOLUTION if family.optimize_rate else COARSE
    rates = Rates(
        resolution=resolution, nearest=NEAREST, bits=digits(FEWEST_BITS), always=True, words="found"
    )
    return (yield from propose(program, family, family.limit, rates))


@dataclass(frozen=True, slots=True)
class _Solution:
    """What a solver found, in the coordinates of a family."""

    functions: Array  # Shape (corners, n, n)
    multipliers: Array  # Shape (sets, 2, n, n): F, and G in seconds
    rate: float  # Rate of the solved program


@dataclass(frozen=True, slots=True)
class _Program:
    """One inequality for each set of modes and each corner of the constant parameters."""

    modes: Array  # Shape (sets, corners, n, n), in coordinates in which their norms are round
    time: Time
    unit: int  # Logarithm of the unit of time in s, to the base two
    coordinates: Array  # Shape (n, n); x = T z
    exponents: Indices  # Scaling of the family

    @classmethod
    def of(cls, family: Family, coordinates: Array) -> _Program:
        """Take the modes of a family."""
        system = family.system
        index = {mode.name: k for k, mode in enumerate(system.modes)}
        sets = np.array([[index[name] for name in c] for c in system.switching.fixed_ends])
        modes: Array = np.asarray(np.linalg.solve(coordinates, family.matrices @ coordinates))
        unit = time_unit(modes, system.time)
        return cls(np.ldexp(modes, unit)[sets], system.time, unit, coordinates, family.exponents)

    def solve(self, rate: float, allowance: Allowance) -> _Solution | None:
        """Make the margin of all inequalities as large as it gets with ``P <= I``."""
        sets, corners, n = self.modes.shape[:3]
        basis = symmetric_basis(n)
        size, square = len(basis), n * n
        unknowns = corners * size + 2 * sets * square + 1
        program, zero = SemidefiniteProgram(unknowns), np.zeros((2 * n, 2 * n))
        for k in range(corners):
            program.add(np.eye(n), [(k * size, -np.eye(size))])
        functions = packed_columns(self._function_forms(basis, rate))
        margin = unknowns - 1, packed_columns(-np.eye(2 * n)[None])
        for k in range(sets):
            at = corners * size + 2 * k * square
            for v, A in enumerate(self.modes[k]):
                multipliers = packed_columns(_multiplier_forms(A))
                program.add(zero, [(v * size, functions), (at, multipliers), margin])
        found = program.maximize(allowance)
        if found is None or found.x[-1] <= 0:
            return None
        x = found.x
        P = np.tensordot(x[: corners * size].reshape(corners, size), basis, axes=1)
        slack = x[corners * size : -1].reshape(sets, 2, n, n)
        inverse = np.linalg.inv(self.coordinates)
        slack[:, 1] = np.ldexp(slack[:, 1], self.unit)
        functions, slack = inverse.T @ P @ inverse, inverse.T @ slack @ inverse
        scale = int(np.frexp(np.abs(functions).max())[1])
        return _Solution(np.ldexp(functions, -scale), np.ldexp(slack, -scale), rate)

    def own_rate(self, solution: _Solution) -> float:
        """Return the rate of the solved program."""
        return solution.rate

    def roundings(
        self, solution: _Solution, claim: Fraction, digits: Sequence[int], *, errors: bool = False
    ) -> Iterator[ConstantsQuadratic]:
        """Yield roundings to integers; G needs more bits for its unit."""
        top, more = max(int(self.exponents.max()), 0), max(-self.unit, 0)
        shifts = top - self.exponents
        for bits in (bits + more for bits in digits):
            yield ConstantsQuadratic(
                tuple(round_form(P, shifts, bits) for P in solution.functions),
                tuple(
                    (round_matrix(F, shifts, bits), round_matrix(G, shifts, bits))
                    for F, G in solution.multipliers
                ),
                bits + 2 * top,
                claim,
            )

    def _function_forms(self, basis: Array, rate: float) -> Array:
        """Return the forms of the entries of P in an inequality, shape (N, 2n, 2n)."""
        nothing = np.zeros_like(basis)
        if self.time is Time.CONTINUOUS:
            slow = -2 * float(np.ldexp(rate, self.unit)) * basis
            return np.block([[slow, -basis], [-basis, nothing]])
        return np.block([[rate**2 * basis, nothing], [nothing, -basis]])


def _multiplier_forms(A: Array) -> Array:
    """Return the forms of the entries of F, then of G, shape (2 n^2, 2n, 2n)."""
    n = len(A)
    E = np.eye(n * n).reshape(n * n, n, n)
    turned, moved = np.swapaxes(E, 1, 2), E @ A
    back, nothing = np.swapaxes(moved, 1, 2), np.zeros_like(E)
    first = np.block([[-(moved + back), E], [turned, nothing]])
    second = np.block([[nothing, -back], [-moved, E + turned]])
    return np.concatenate([first, second])
