"""Search for one quadratic function for contact and free motion (untrusted)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.mode import Time
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.conewise_program import (
    ConewiseSolution,
    Motions,
    best_rate,
    find_conewise_quadratic,
    separating_coordinates,
)
from nrs_design.search.decay import fastest_first
from nrs_design.search.draw import one_form
from nrs_design.search.family import Family, to_floats
from nrs_design.search.rounding import claims, digits, rate_at, round_rate, unscale
from nrs_design.work import Allowance, NotAffordableError

Array = NDArray[np.float64]
# What the arithmetic rounds takes a little more than in the first order.
LOST = 1.25
# Few roundings: more digits at once, as every check takes longer.
WITH_ERRORS = (24, 32, 40, 50, 60)


@dataclass(frozen=True)
class RoundingErrors:
    """What the arithmetic rounds, in floating point."""

    # Shape (k, r, n). Where each rounding acts, for every mode and free mode, in the coordinates of
    # a family.
    columns: Array
    rows: Array  # Shape (k, r, n). How large it is at most, over the state.

    @classmethod
    def of(cls, family: Family) -> RoundingErrors:
        """Convert the roundings of a system to the coordinates of a family."""
        d, n = family.exponents, len(family.exponents)
        items = family.system.roundings
        columns = np.stack([to_floats(item.columns)[:, :, 0] for item in items], axis=1)
        rows = np.stack([to_floats(item.rows)[:, 0, :n] for item in items], axis=1)
        return cls(np.ldexp(columns, -d), np.ldexp(rows, d))

    def allow_for(self, Q: Array, claim: Fraction) -> tuple[Array, Fraction]:
        """Return multipliers, and what is left of a rate if the function loses what they take.

        In the norm of Q, an error of size ``s`` times that of the state, where a step keeps at
        most that size, takes ``2 s`` of V; with the multiplier ``|C| / |q|`` half of it is taken by
        either term.

        Parameters
        ----------
        Q : ndarray, shape (n, n)
            In the coordinates of the family.
        claim : Fraction
            The contraction rho that holds without errors.
        """
        L = np.linalg.cholesky(Q)
        pushed = np.linalg.norm(self.columns @ L, axis=-1).max(axis=0)
        sizes = np.linalg.norm(self.rows @ np.linalg.inv(L).T, axis=-1).max(axis=0)
        loss = LOST * float((2 * pushed * sizes).sum())
        taus = np.divide(pushed, sizes, out=np.ones_like(pushed), where=sizes > 0)
        return taus, round_rate(float(np.sqrt(float(claim) ** 2 + loss)), Time.DISCRETE)


def search_conewise(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a function for contact and free motion; then, if asked to, raise the rate.

    Where the arithmetic rounds, functions that cover that are tried before others.
    """
    if family.system.roundings:
        yield from _search(family, RoundingErrors.of(family))
    if family.system.contact is None:
        return NO_MARGIN
    return (yield from _search(family, None))


def _search(family: Family, errors: RoundingErrors | None) -> Candidates[FormsOnGraph]:
    system = family.system
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    motions = Motions.of(family)
    T = separating_coordinates(motions)
    own = motions.transformed(T)
    if not all(np.isfinite(part).all() for part in (T, own.contact, own.free, own.pulls)):
        return OUT_OF_RANGE
    solution = find_conewise_quadratic(
        own, rate_at(0.0, family.limit, system.time), family.allowance
    )
    if solution is None:
        return NO_MARGIN
    if family.optimize_rate:
        yield from _fastest(family, own, T, errors)
    for claim in claims(1.0, best_rate(own, solution), system.time):
        for evidence in _roundings(family, solution, T, claim, errors):
            yield Candidate(evidence)
    return None


def _fastest(
    family: Family, own: Motions, T: Array, errors: RoundingErrors | None
) -> Iterator[Candidate[FormsOnGraph]]:
    """Yield functions for the largest rates that fit into the budget."""

    def solve(rate: float, allowance: Allowance) -> ConewiseSolution | None:
        return find_conewise_quadratic(own, rate, allowance)

    try:
        for solution, claim in fastest_first(
            solve, family.limit, family.system.time, family.allowance
        ):
            for evidence in _roundings(family, solution, T, claim, errors):
                yield Candidate(evidence, "found with the largest decay rate")
    except NotAffordableError:
        return


def _roundings(
    family: Family,
    solution: ConewiseSolution,
    T: Array,
    claim: Fraction,
    errors: RoundingErrors | None,
) -> Iterator[FormsOnGraph]:
    """Yield roundings of a solution in coordinates ``x = T z`` of the family.

    A multiplier belongs to the product of the deflection and a force, or of the deflection and its
    next value; its scale changes with that of the deflection.
    """
    inverse = np.linalg.inv(T)
    Q = inverse.T @ solution.Q @ inverse
    exponent = int(np.frexp(np.abs(Q).max())[1])
    contact = family.system.contact or Contact(())
    times = multiplied(contact, family.system.time)
    scaled = in_numerators(solution.multipliers / T[-1, -1] ** times, contact, family.system.time)
    scaled = np.ldexp(scaled, -exponent - times * int(family.exponents[-1]))
    taus = np.zeros(0)
    if errors is not None:
        taus, claim = errors.allow_for(np.ldexp(Q, -exponent), claim)
    if claim >= 1 and errors is not None:
        return
    for bits in digits() if errors is None else WITH_ERRORS:
        rows, log2 = unscale(np.ldexp(Q, -exponent), family.exponents, bits)
        multipliers, roundings = numerators(scaled, log2), numerators(taus, log2)
        log2 = max(log2, 0)
        lost = family.system.contact is not None
        yield one_form(
            family.system,
            rows,
            log2,
            claim,
            crossings=multipliers if lost else (),
            roundings=roundings,
            lost=lost,
        )


def multiplied(contact: Contact, time: Time) -> NDArray[np.int64]:
    """Return for each multiplier how often the deflection is in its product."""
    if time is Time.CONTINUOUS:
        return np.ones(len(contact.free) * len(contact.pulls), dtype=np.int64)
    return np.array([2, *[1, 1, 2] * len(contact.pulls)])


def in_numerators(multipliers: Array, contact: Contact, time: Time) -> Array:
    """Return multipliers of forces, in discrete time as those of their numerators.

    Parameters
    ----------
    multipliers : ndarray
        As a search finds them.
    contact : Contact
        With the forces.
    time : Time
        Continuous or discrete.
    """
    if time is Time.CONTINUOUS:
        return multipliers
    below = [d for q in contact.pulls for d in (q.denominator, q.denominator, 1)]
    return np.asarray(multipliers / np.array([1, *below][: len(multipliers)], dtype=float))


def numerators(multipliers: Array, log2: int) -> tuple[int, ...]:
    """Round multipliers to integers over two to a power; none becomes negative."""
    whole = Fraction(2) ** log2
    return tuple(round(max(Fraction(float(entry)), Fraction(0)) * whole) for entry in multipliers)
