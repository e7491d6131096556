"""Search for one quadratic function for each step of a round, where modes take turns (untrusted).

Margin form, with every condition of `nrs_design.proof.evidence.periodic_quadratic`. Each step has
coordinates of its own, in which what a mean mode keeps of the state until it is at rest is round.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.clock import on_turn
from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Clock
from nrs_design.search.balance import own_norm, scale_states
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.conewise_program import LARGEST_MULTIPLIER, Motions
from nrs_design.search.conewise_quadratic import (
    LOST,
    WITH_ERRORS,
    RoundingErrors,
    in_numerators,
    multiplied,
    numerators,
)
from nrs_design.search.decay import fastest_first, limit_rate
from nrs_design.search.draw import in_turns
from nrs_design.search.family import Family, stand_ins, to_floats
from nrs_design.search.rounding import claims, digits, rate_at, round_form, round_rate
from nrs_design.search.sdp import begin, maximize_margin, pack, program_cost, symmetric_basis
from nrs_design.work import Allowance, Cost, NotAffordableError

Array = NDArray[np.float64]
# Where unknowns begin, and what a form takes from each of them.
Parts = list[tuple[int, Array]]

# The mean of all modes of a round may grow: what is kept of it then is this.
KEPT = 0.99
FEWEST_BITS = 24
# The rate is bracketed to this share of itself: every solution takes long.
RESOLUTION = 2.0**-5
# At the largest rate itself there is no room for rounding.
NEAREST = 0.99
# Where more conditions than this are to be checked, what the arithmetic rounds is left out.
MOST_ROUNDED = 250


@dataclass(frozen=True)
class PeriodicSolution:
    """The functions of all steps and their multipliers, in floating point."""

    functions: list[Array]
    multipliers: Array


@dataclass(frozen=True)
class StepInequality:
    """One form that must be positive, of the functions before and after a step."""

    step: int  # Of the round
    map: Array  # Shape (m, n). Of the states that there are before to those after.
    undeflected: bool = False  # Whether the deflection is none of those before
    # Which multipliers of the step enter, and their forms.
    crossings: tuple[tuple[int, Array], ...] = ()

    def before(self, Q: Array) -> Array:
        """Return the function before the step."""
        return Q[..., :-1, :-1] if self.undeflected else Q

    def after(self, Q: Array) -> Array:
        """Return what the function after the step is of the states before."""
        m = len(self.map)
        return np.asarray(self.map.T @ Q[..., :m, :m] @ self.map)


class PeriodicProgram:
    """The semidefinite program for any rate, in coordinates of each step."""

    def __init__(self, family: Family, clock: Clock) -> None:
        self.family, self.clock = family, clock
        self.parts = [self._part(step) for step in range(2)]
        self.motions = [self._distinct(Motions.of(part)) for part in self.parts]
        self.contact = family.system.contact
        self.per_step = len(multiplied(self.contact, Time.DISCRETE)) if self.contact else 0
        self.n = family.system.order
        self.T = self._coordinates()

    def _part(self, step: int) -> Family:
        part = on_turn(self.family.system, self.clock, step)
        matrices = scale_states(to_floats([mode.A for mode in part.modes]), self.family.exponents)
        return Family(part, matrices, self.family.exponents, self.family.limit)

    @staticmethod
    def _distinct(motions: Motions) -> Motions:
        """Leave out modes that differ by the last digits of an enclosed number."""

        def first(matrices: Array) -> Array:
            names = [str(i) for i in range(len(matrices))]
            return matrices[
                [int(i) for i, other in stand_ins(names, matrices).items() if i == other]
            ]

        return Motions(motions.time, first(motions.contact), first(motions.free), motions.pulls)

    def _coordinates(self) -> list[Array]:
        """Return the T of every step, which leave the deflection alone."""
        means = [motions.contact.mean(axis=0) for motions in self.motions]
        each = [means[min(step, 1)] for step in range(self.clock.length)]
        whole = np.eye(self.n)
        for mean in each:
            whole = mean @ whole
        radius = float(np.abs(np.linalg.eigvals(whole)).max())
        share = min(1.0, (KEPT / radius) ** (1 / len(each))) if radius > 0 else 1.0
        # In coordinates of like size, all is counted at every step.
        form, forms = own_norm(share ** len(each) * whole, Time.DISCRETE), list[Array]()
        for mean in reversed(each * 2):
            form = np.eye(self.n) / len(each) + share**2 * mean.T @ form @ mean
            forms.append(form)
        found = forms[: -len(each) - 1 : -1]
        return [self._round(P) for P in found]

    def _round(self, P: Array) -> Array:
        if self.contact is None:
            return np.asarray(np.linalg.inv(np.linalg.cholesky(P)).T)
        T = np.zeros_like(P)
        T[:-1, :-1] = np.linalg.inv(np.linalg.cholesky(P[:-1, :-1])).T
        T[-1, -1] = 1 / np.sqrt(P[-1, -1])
        return T

    @property
    def is_finite(self) -> bool:
        """Whether floating point holds the coordinates and the modes."""
        parts = (*self.T, *(part for m in self.motions for part in (m.contact, m.free, m.pulls)))
        return all(np.isfinite(part).all() for part in parts)

    def limit(self) -> float:
        """Return the contraction per step of the slowest round of like modes."""
        slowest = 0.0
        for first in self.motions[0].contact:
            for other in self.motions[1].contact:
                whole = np.linalg.matrix_power(other, self.clock.length - 1) @ first
                slowest = max(slowest, limit_rate(whole[None], Time.DISCRETE))
        return float(slowest ** (1 / self.clock.length))

    def conditions(self) -> Iterator[StepInequality]:
        """Yield every condition but that of the functions themselves."""
        n, last = self.n, np.eye(self.n)[-1]
        for step in range(self.clock.length):
            own = self.motions[min(step, 1)]
            T, inverse = self.T[step], np.linalg.inv(self.T[(step + 1) % self.clock.length])
            for A in inverse @ own.contact @ T:
                yield StepInequality(step, A)
                if self.contact is not None:
                    yield StepInequality(step, A[:-1], crossings=((0, _crossing(last, A[-1])),))
            for F in inverse @ own.free @ T:
                yield StepInequality(step, F[: n - 1, :-1], undeflected=True)
                yield StepInequality(step, F[:, :-1], undeflected=True)
                for k, q in enumerate(own.pulls @ T):
                    pulled = _crossing(last, q)
                    yield StepInequality(step, F, crossings=((3 * k + 1, pulled),))
                    lost = (3 * k + 2, pulled), (3 * k + 3, _crossing(last, F[-1]))
                    yield StepInequality(step, F[:-1], crossings=lost)

    def cost(self) -> tuple[Cost, str]:
        """Predict what one solution takes; say for what."""
        own, N = self.n * (self.n + 1) // 2, self.clock.length
        count = sum(1 for _ in self.conditions())
        unknowns = N * (own + self.per_step) + 1
        cones = [(self.n, own)] * 2 * N + [(self.n, 2 * own)] * count
        return program_cost(unknowns, own * 3, cones), f"a program with {len(cones)} blocks"

    def solve(self, rate: float, allowance: Allowance) -> PeriodicSolution | None:
        """Maximize the margin at a rate; None if it is not positive.

        Raises
        ------
        NotAffordableError
            If work or memory do not suffice.
        """
        begun = begin(allowance, *self.cost())
        basis, N = symmetric_basis(self.n), self.clock.length
        own, lost = len(basis), self.per_step
        unknowns = N * (own + lost) + 1
        rows, offsets, sizes = list[Array](), list[Array](), list[int]()

        def add(parts: Parts, size: int, *, margin: float = 0.0, constant: float = 0.0) -> None:
            block = np.zeros((size * (size + 1) // 2, unknowns))
            for place, images in parts:
                block[:, place : place + len(images)] -= pack(images).T
            block[:, -1] = margin * pack(np.eye(size))
            rows.append(block)
            offsets.append(constant * pack(np.eye(size)))
            sizes.append(size)

        for step in range(N):
            add([(step * own, basis)], self.n, margin=1.0)
            add([(step * own, -basis)], self.n, constant=1.0)
        for place in range(N * own, unknowns - 1):
            add([(place, np.ones((1, 1, 1)))], 1)
            add([(place, -np.ones((1, 1, 1)))], 1, constant=LARGEST_MULTIPLIER)
        for item in self.conditions():
            crossings = [(N * own + item.step * lost + k, form[None]) for k, form in item.crossings]
            before = item.step * own, rate**2 * item.before(basis)
            after = (item.step + 1) % N * own, -item.after(basis)
            add([before, after, *crossings], before[1].shape[-1], margin=1.0)
        x = maximize_margin(np.vstack(rows), np.concatenate(offsets), sizes, begun)
        if x is None or x[-1] <= 0:
            return None
        functions = [np.tensordot(c, basis, axes=1) for c in x[: N * own].reshape(N, own)]
        return PeriodicSolution(functions, x[N * own : -1].reshape(N, lost))

    def own_rate(self, solution: PeriodicSolution) -> float:
        """Return the contraction per step that a solution shows."""
        worst = 0.0
        for item in self.conditions():
            Q = item.before(solution.functions[item.step])
            form = item.after(solution.functions[(item.step + 1) % self.clock.length])
            for k, crossing in item.crossings:
                form = form - solution.multipliers[item.step, k] * crossing
            inverse = np.linalg.inv(np.linalg.cholesky(Q))
            worst = max(worst, float(np.linalg.eigvalsh(inverse @ form @ inverse.T)[-1]))
        return float(np.sqrt(worst))

    def roundings(
        self, solution: PeriodicSolution, claim: Fraction, *, errors: bool
    ) -> Iterator[FormsOnGraph]:
        """Yield roundings of all functions to integers over one denominator.

        Parameters
        ----------
        solution : PeriodicSolution
            For which the claim holds in floating point.
        claim : Fraction
            The contraction rho per step.
        errors : bool
            Whether what the arithmetic rounds is covered, at a rate that leaves room for it.
        """
        d = self.family.exponents
        whole = []
        for T, Q in zip(self.T, solution.functions, strict=True):
            inverse = np.linalg.inv(T)
            whole.append(inverse.T @ Q @ inverse)
        exponent = int(np.frexp(max(np.abs(Q).max() for Q in whole))[1])
        scaled = [np.ldexp(Q, -exponent) for Q in whole]
        multipliers = [
            np.ldexp(self._unscaled(step, entries), -exponent)
            for step, entries in enumerate(solution.multipliers)
        ]
        taus = list[Array]()
        if errors:
            taus, claim = self._allow_for(scaled, claim)
            if claim >= 1:
                return
        top = int(d.max())
        for bits in WITH_ERRORS if errors else digits(FEWEST_BITS):
            log2 = bits + 2 * top
            functions = tuple(round_form(Q, top - d, bits) for Q in scaled)
            yield in_turns(
                self.family.system,
                functions,
                max(log2, 0),
                claim,
                tuple(numerators(part, log2) for part in multipliers) if self.contact else (),
                tuple(numerators(part, log2) for part in taus),
            )

    def _unscaled(self, step: int, entries: Array) -> Array:
        """Return the multipliers of a step as those of the states of the system."""
        if self.contact is None:
            return entries
        T, after = self.T[step][-1, -1], self.T[(step + 1) % self.clock.length][-1, -1]
        times = multiplied(self.contact, Time.DISCRETE)
        below = np.where(times == 2, T * after, T)
        found = in_numerators(entries / below, self.contact, Time.DISCRETE)
        return np.asarray(np.ldexp(found, -times * int(self.family.exponents[-1])))

    def _allow_for(self, functions: list[Array], claim: Fraction) -> tuple[list[Array], Fraction]:
        """Return multipliers of roundings for each step, and what is left of the rate."""
        roots = [np.linalg.cholesky(Q) for Q in functions]
        errors, found, worst = [RoundingErrors.of(part) for part in self.parts], list[Array](), 0.0
        for step, L in enumerate(roots):
            own = errors[min(step, 1)]
            after = roots[(step + 1) % len(roots)]
            pushed = np.linalg.norm(own.columns @ after, axis=-1).max(axis=0)
            sizes = np.linalg.norm(own.rows @ np.linalg.inv(L).T, axis=-1).max(axis=0)
            worst = max(worst, LOST * float((2 * pushed * sizes).sum()))
            acts = (sizes > 0) & (pushed > 0)
            found.append(np.divide(pushed, sizes, out=np.ones_like(pushed), where=acts))
        return found, round_rate(float(np.sqrt(float(claim) ** 2 + worst)), Time.DISCRETE)


def _crossing(last: Array, row: Array) -> Array:
    return np.asarray(np.outer(last, row) + np.outer(row, last))


def _fastest(
    program: PeriodicProgram, limit: float, *, errors: bool
) -> Iterator[Candidate[FormsOnGraph]]:
    """Yield functions for the largest rates that fit into half of the budget."""
    half = program.family.allowance.part(0.5)
    try:
        for solution, claim in fastest_first(
            program.solve,
            limit,
            Time.DISCRETE,
            half,
            resolution=RESOLUTION,
            nearest=NEAREST,
            few=True,
        ):
            for evidence in program.roundings(solution, claim, errors=errors):
                yield Candidate(evidence, "found with the largest decay rate")
    except NotAffordableError:
        return


def search_periodic_quadratic(family: Family) -> Candidates[FormsOnGraph]:
    """Search for the functions; then, if asked to, raise the rate.

    Where the arithmetic rounds, functions that cover that are tried before others, unless there are
    too many conditions to check.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    system, clock = family.system, family.system.clock
    if clock is None:
        return NO_MARGIN
    program = PeriodicProgram(family, clock)
    if not program.is_finite:
        return OUT_OF_RANGE
    limit = program.limit()
    free = (system.contact or Contact(())).free
    checked = (len(system.modes) + len(free)) * clock.length
    ways = (True, False) if system.roundings and checked <= MOST_ROUNDED else (False,)
    first = program.solve(rate_at(0.0, limit, Time.DISCRETE), family.allowance)
    if first is None:
        return NO_MARGIN
    for errors in ways:
        if family.optimize_rate:
            yield from _fastest(program, limit, errors=errors)
        for claim in claims(1.0, program.own_rate(first), Time.DISCRETE):
            for evidence in program.roundings(first, claim, errors=errors):
                yield Candidate(evidence)
    return None
