"""Search for a common homogeneous polynomial Lyapunov function.

``V(x) = z' Q z`` with z the monomials of degree d. The derivative along a mode is
``z' (L'Q + QL) z`` with the lifted mode L, and any form that vanishes identically may be added to
its Gram matrix. The existence of such a function for some degree is necessary for stability
under arbitrary switching too (Mason, Boscain and Chitour 2006).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import comb

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import MAX_DEGREE, MAX_MONOMIALS, lifted
from nrs_design.proof.exact import lyapunov_factor
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.steps import map_step
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import NO_MARGIN, Candidate, Candidates
from nrs_design.search.decay import bisect_position
from nrs_design.search.draw import one_form
from nrs_design.search.family import Family
from nrs_design.search.lifted import Lift, Pair, lift_family, orthonormal, products, vanishing_in
from nrs_design.search.lmi import decreases
from nrs_design.search.rounding import claims, digits, rate_at, round_form
from nrs_design.search.sdp import (
    begin,
    maximize_margin,
    pack,
    program_cost,
    symmetric_basis,
)
from nrs_design.work import Allowance, Cost, NotAffordableError

Array = NDArray[np.float64]

# Solutions take time: the largest rate is bracketed to this share of the slowest mode's, and the
# function for a little less is rounded.
SMALLEST = 2.0**-8
BACK_OFF = 0.98
NEAREST = 0.99
FEWEST_BITS = 10
HELD = f"a certificate holds at most {MAX_MONOMIALS} monomials and degree {MAX_DEGREE}"


@dataclass(frozen=True)
class PolynomialSolution:
    """Gram matrix Q, shape (K, K), and one vanishing form per mode, shape (m, K, K)."""

    Q: Array
    vanishing: Array


def search_polynomial(family: Family, degree: int) -> Candidates[FormsOnGraph]:
    """Search for a common homogeneous polynomial of degree 2d, and a large rate if asked to.

    Parameters
    ----------
    family : Family
        The modes.
    degree : int
        The d of a form of degree 2d.
    """
    system, allowance = family.system, family.allowance
    allowance.require(*family_cost(system, degree))
    lift = lift_family(system, family.exponents, degree)
    least = rate_at(0.0, family.limit, system.time)
    solution = find_common_polynomial(lift, system.time, least, allowance)
    if solution is None:
        return NO_MARGIN
    if family.optimize_rate and (faster := _faster(family, lift)) is not None:
        for evidence in _roundings(family, lift, faster):
            yield Candidate(evidence, "found with a decay rate near the largest")
    for evidence in _roundings(family, lift, solution):
        yield Candidate(evidence)
    return None


def _faster(family: Family, lift: Lift) -> PolynomialSolution | None:
    """Bisect for the largest rate, and solve for one a little below it."""
    time = family.system.time

    def solve(position: float) -> PolynomialSolution | None:
        rate = rate_at(position, family.limit, time)
        return find_common_polynomial(lift, time, rate, family.allowance)

    best = bisect_position(lambda s: solve(s) is not None, 0.0, SMALLEST)
    try:
        return solve(BACK_OFF * best) if best > 0 else None
    except NotAffordableError:
        return None


def highest_degree(variables: int) -> int:
    """Return the largest d whose monomials a certificate can hold."""
    degrees = range(1, MAX_DEGREE // 2 + 1)
    fitting = (d for d in degrees if comb(variables + d - 1, d) <= MAX_MONOMIALS)
    return max(fitting, default=1)


def polynomial_cost(variables: int, modes: int, degree: int) -> tuple[Cost, str]:
    """Predict what `find_common_polynomial` takes before anything is lifted; say for what.

    Parameters
    ----------
    variables : int
        States.
    modes : int
        How many.
    degree : int
        The d of a form of degree 2d.
    """
    order = comb(variables + degree - 1, degree)
    shared = order * (order + 1) // 2 + 1
    forms = shared - 1 - comb(variables + 2 * degree - 1, 2 * degree)
    cones = [(order, shared)] * 2 + [(order, shared + forms)] * modes
    return program_cost(shared + modes * forms, shared, cones), f"a program in {order} monomials"


def family_cost(system: SwitchedSystem, degree: int) -> tuple[Cost, str]:
    """Predict the same for a system; see `polynomial_cost`."""
    return polynomial_cost(system.order, len(system.modes), degree)


def find_common_polynomial(
    lift: Lift, time: Time, rate: float, allowance: Allowance | None = None
) -> PolynomialSolution | None:
    """Maximize the margin by semidefinite programming.

    Parameters
    ----------
    lift : Lift
        As `lift_family` gives it.
    time : Time
        Continuous or discrete.
    rate : float
        alpha in 1/s, or rho per step.
    allowance : Allowance, optional
        Work and memory; unlimited by default.

    Returns
    -------
    PolynomialSolution or None
        None if the margin is not positive.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    allowance = allowance or Allowance()
    begun = begin(allowance, *polynomial_cost(lift.variables, len(lift.matrices), lift.degree))
    m, K = lift.matrices.shape[:2]
    basis, identity = symmetric_basis(K), pack(np.eye(K))
    size, forms = len(basis), len(lift.vanishing)
    width = size + m * forms + 1
    bounds = np.zeros((2 * size, width))
    bounds[:size, :size], bounds[size:, :size] = np.eye(size), -np.eye(size)
    blocks = decrease_blocks(lift, basis, time, rate, size, width)
    offset = np.concatenate([identity, np.zeros(size * (m + 1))])
    x = maximize_margin(np.vstack([bounds, *blocks]), offset, [K] * (m + 2), begun)
    if x is None or x[-1] <= 0:
        return None
    return PolynomialSolution(np.tensordot(x[:size], basis, axes=1), vanishing_in(lift, x[size:-1]))


def decrease_blocks(
    lift: Lift, images: Array, time: Time, rate: float, first: int, width: int
) -> list[Array]:
    """Return the rows that ask for a decrease in each mode, for `maximize_margin`.

    The unknowns are the coordinates of Q, then, from one column on, those of a vanishing form for
    each mode, and the margin as the last.

    Parameters
    ----------
    lift : Lift
        The modes.
    images : ndarray, shape (p, K, K)
        What a unit of each coordinate of Q is in the monomials of the modes.
    time : Time
        Continuous or discrete.
    rate : float
        alpha in 1/s, or rho per step.
    first : int
        Column of the first vanishing form.
    width : int
        Number of unknowns.
    """
    rate = float(np.ldexp(rate, lift.unit))
    lifted_rate = rate * lift.degree if time is Time.CONTINUOUS else rate**lift.degree
    directions, identity = pack(orthonormal(lift.vanishing)), pack(np.eye(images.shape[-1]))
    blocks, forms = [], len(directions)
    for k, A in enumerate(lift.matrices):
        block = np.zeros((len(identity), width))
        block[:, : len(images)] = -pack(decreases(A, images, time, lifted_rate)).T
        block[:, first + k * forms : first + (k + 1) * forms] = -directions.T
        block[:, -1] = identity
        blocks.append(block)
    return blocks


def _roundings(family: Family, lift: Lift, solution: PolynomialSolution) -> Iterator[FormsOnGraph]:
    """Yield roundings to integers at rates just below the one that a solution shows itself."""
    system = family.system
    own = shown_rate(lift, solution, system.time)
    slower = min if system.time is Time.CONTINUOUS else max
    for claim in claims(1.0, slower(own, family.limit), system.time, NEAREST):
        for bits in digits(FEWEST_BITS):
            yield _integers(system, lift, solution, claim, bits)


def shown_rate(lift: Lift, solution: PolynomialSolution, time: Time) -> float:
    """Return the rate that Q and the vanishing forms show, by generalized eigenvalues.

    Parameters
    ----------
    lift : Lift
        The modes.
    solution : PolynomialSolution
        In their coordinates.
    time : Time
        Continuous or discrete.
    """
    forms = decreases(lift.matrices, solution.Q, time, 0.0) + solution.vanishing
    inverse = np.linalg.inv(np.linalg.cholesky(solution.Q))
    smallest = float(np.linalg.eigvalsh(inverse @ forms @ inverse.T).min())
    if time is Time.CONTINUOUS:
        return float(np.ldexp(smallest / (2 * lift.degree), -lift.unit))
    return float(max(-smallest, 0.0) ** (0.5 / lift.degree))


def _integers(
    system: SwitchedSystem, lift: Lift, solution: PolynomialSolution, rate: Fraction, bits: int
) -> FormsOnGraph:
    lowest, normalized = int(lift.exponents.min()), int(np.frexp(np.abs(solution.Q).max())[1])
    return one_form(
        system,
        round_form(solution.Q, lift.exponents - lowest, bits - normalized),
        max(0, bits - 2 * lowest),
        rate,
        lift.degree,
        vanishing=round_vanishing(system, lift, solution, rate, bits - normalized, lowest),
    )


def round_vanishing(
    system: SwitchedSystem,
    lift: Lift,
    solution: PolynomialSolution,
    rate: Fraction,
    bits: int,
    lowest: int,
) -> tuple[tuple[tuple[int, ...], ...], ...]:
    """Round the vanishing form of each mode so that it vanishes exactly.

    Parameters
    ----------
    system : SwitchedSystem
        The exact modes.
    lift : Lift
        Of them.
    solution : PolynomialSolution
        In its coordinates.
    rate : Fraction
        The claim.
    bits : int
        After the binary point, in these coordinates.
    lowest : int
        The exponent of the unit of the integers; none of the lift is lower.
    """
    groups, forms = products(system.order, lift.degree), []
    for mode, N in zip(system.modes, solution.vanishing, strict=True):
        # The integer form of the decrease is this multiple of the floating-point one.
        factor = _factor(mode, lift.degree, rate, system.time)
        rounded = [
            [_shift(factor * entry, -lift.unit) for entry in row]
            for row in round_form(N, lift.exponents - lowest, bits)
        ]
        forms.append(tuple(map(tuple, make_vanish(rounded, groups))))
    return tuple(forms)


def _factor(mode: Mode, degree: int, rate: Fraction, time: Time) -> int:
    """Return what the exact check multiplies a decrease with."""
    if time is Time.CONTINUOUS:
        return lyapunov_factor(mode.A.denominator, degree * rate)
    step = map_step("", mode.name, ("", ""), mode.A, 1)
    return int(lifted(step, degree, rate).units[0]) ** 2


def _shift(value: int, exponent: int) -> int:
    return value << exponent if exponent >= 0 else value >> -exponent


def make_vanish(N: list[list[int]], groups: list[list[Pair]]) -> list[list[int]]:
    """Correct one entry for each product of monomials so that ``z' N z`` vanishes exactly."""
    for group in groups:
        total = sum(N[i][j] * (1 if i == j else 2) for i, j in group)
        i, j = group[0]
        # Without a diagonal pair in the group, the total is even.
        N[i][j] -= total if i == j else total // 2
        N[j][i] = N[i][j]
    return N
