"""Search for one quadratic function per mode for contact and free motion in steps (untrusted).

Margin form, with every condition of `nrs_design.proof.evidence.conewise_mode_quadratic`. Modes that
differ by the last digits of an enclosed number share their function, and the search sees one.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate, pairwise

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import Arc, Multiplier, Node
from nrs_design.proof.steps import CONTACT, FREE, LOST
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.conewise_program import LARGEST_MULTIPLIER, Motions, separating_coordinates
from nrs_design.search.conewise_quadratic import numerators
from nrs_design.search.decay import fastest_first
from nrs_design.search.family import Family, stand_ins
from nrs_design.search.rounding import claims, digits, rate_at, round_form
from nrs_design.search.sdp import begin, maximize_margin, pack, program_cost, symmetric_basis
from nrs_design.work import Allowance, Cost

Array = NDArray[np.float64]
# What a condition takes from the functions and multipliers, by their places.
Terms = list[tuple[int, Array]]

FEWEST_BITS = 12
# What is left of the budget is for simpler functions in kept contact.
SHARE = 0.25


@dataclass(frozen=True)
class ConewiseModeSolution:
    """Functions in contact and free, and a multiplier for each free mode, in floating point."""

    touching: list[Array]
    flying: list[Array]
    multipliers: Array


class ConewiseModeProgram:
    """The semidefinite program for any rate, in coordinates that keep the deflection apart."""

    def __init__(self, family: Family) -> None:
        system = family.system
        contact = system.contact or Contact(())
        self.family, self.all = family, Motions.of(family)
        self.T = separating_coordinates(self.all)
        own = self.all.transformed(self.T)
        self.named = [
            stand_ins([mode.name for mode in system.modes], self.all.contact),
            stand_ins([mode.name for mode in contact.free], self.all.free),
        ]
        self.contact = self._kept(own.contact, self.named[0])
        self.free = self._kept(own.free, self.named[1])
        self.n = own.contact.shape[-1]

    @staticmethod
    def _kept(matrices: Array, named: dict[str, str]) -> Array:
        return np.array([A for A, (a, b) in zip(matrices, named.items(), strict=True) if a == b])

    @property
    def is_finite(self) -> bool:
        """Whether floating point holds the coordinates and the modes in them."""
        return all(np.isfinite(part).all() for part in (self.T, self.contact, self.free))

    def cost(self) -> tuple[Cost, str]:
        """Predict what one solution takes; say for what."""
        m, f, n = len(self.contact), len(self.free), self.n
        own, inner = n * (n + 1) // 2, n * (n - 1) // 2
        shared = m * own + f * (inner + 1) + 1
        cones = [(n, 2 * own)] * (2 * m + m * m + m * f)
        cones += [(n - 1, own + inner)] * (2 * f + f * f + 2 * f * m)
        return program_cost(shared, shared, cones), f"a program with {len(cones)} blocks"

    def conditions(
        self, touching: Array, flying: Array, rate: float
    ) -> Iterator[tuple[int, Terms]]:
        """Yield what must be positive definite: which function decreases, and all terms.

        Places are those of the functions in contact, those of free motion, and the multipliers.

        Parameters
        ----------
        touching, flying : ndarray, shape (k, p, n, n) and (k, q, n - 1, n - 1)
            For each function, what its coordinates are: a basis, or a matrix alone.
        rate : float
            The rho.
        """
        m, f = len(self.contact), len(self.free)

        def image(M: Array, Q: Array) -> Array:
            return np.asarray(-M.T @ Q @ M)

        for i, A in enumerate(self.contact):
            before = i, rate**2 * touching[i]
            for j in range(m):
                yield i, [before, (j, image(A, touching[j]))]
            crossing = np.zeros((1, self.n, self.n))
            crossing[0, -1] += A[-1]
            crossing[0, :, -1] += A[-1]
            for g in range(f):
                moved = m + g, image(A[:-1], flying[g])
                yield i, [before, moved, (m + f + g, crossing)]
        for g, F in enumerate(self.free):
            N, before = F[:, :-1], (m + g, rate**2 * flying[g])
            for h in range(f):
                yield m + g, [before, (m + h, image(N[:-1], flying[h]))]
            for j in range(m):
                yield m + g, [before, (j, image(N, touching[j]))]
                inner = touching[j][..., :-1, :-1]
                yield m + g, [before, (j, image(N[:-1], inner))]

    def solve(self, rate: float, allowance: Allowance) -> ConewiseModeSolution | None:
        """Maximize the margin at a rate; None if it is not positive.

        Raises
        ------
        NotAffordableError
            If work or memory do not suffice.
        """
        begun = begin(allowance, *self.cost())
        m, f, n = len(self.contact), len(self.free), self.n
        outer, inner = symmetric_basis(n), symmetric_basis(n - 1)
        widths = [len(outer)] * m + [len(inner)] * f + [1] * f
        ends = [0, *accumulate(widths)]
        places = [slice(a, b) for a, b in pairwise(ends)]
        rows, offsets, cones = [], [], []

        def add(terms: Terms, margin: float = 0.0, constant: float = 0.0) -> None:
            size = terms[0][1].shape[-1]
            block = np.zeros((size * (size + 1) // 2, ends[-1] + 1))
            for place, images in terms:
                block[:, places[place]] -= pack(images).T
            block[:, -1] = margin * pack(np.eye(size))
            rows.append(block)
            offsets.append(constant * pack(np.eye(size)))
            cones.append(size)

        for place, basis in enumerate([outer] * m + [inner] * f):
            add([(place, basis)], margin=1.0)
            add([(place, -basis)], constant=1.0)
        for place in range(m + f, m + 2 * f):
            add([(place, np.ones((1, 1, 1)))])
            add([(place, -np.ones((1, 1, 1)))], constant=LARGEST_MULTIPLIER)
        for _, terms in self.conditions(np.array([outer] * m), np.array([inner] * f), rate):
            add(terms, margin=1.0)
        offset = np.concatenate(offsets)
        x = maximize_margin(np.vstack(rows), offset, cones, begun)
        if x is None or x[-1] <= 0:
            return None
        found = [
            np.tensordot(x[place], basis, axes=1)
            for place, basis in zip(places, [outer] * m + [inner] * f, strict=False)
        ]
        return ConewiseModeSolution(found[:m], found[m:], x[ends[m + f] : -1])

    def own_rate(self, solution: ConewiseModeSolution) -> float:
        """Return the contraction per step that a solution shows."""
        touching = np.array(solution.touching)[:, None]
        flying = np.array(solution.flying)[:, None]
        before, least = [*solution.touching, *solution.flying], 1.0
        first = len(before)
        for source, terms in self.conditions(touching, flying, 1.0):
            weights = [solution.multipliers[k - first] if k >= first else 1.0 for k, _ in terms]
            form = sum(w * part[0] for w, (_, part) in zip(weights, terms, strict=True))
            inverse = np.linalg.inv(np.linalg.cholesky(before[source]))
            least = min(least, float(np.linalg.eigvalsh(inverse @ form @ inverse.T)[0]))
        return float(np.sqrt(max(1.0 - least, 0.0)))

    def roundings(self, solution: ConewiseModeSolution, claim: Fraction) -> Iterator[FormsOnGraph]:
        """Yield roundings of all functions to integers over one denominator."""
        inverse, d = np.linalg.inv(self.T), self.family.exponents
        touching = [inverse.T @ Q @ inverse for Q in solution.touching]
        inner = inverse[:-1, :-1]
        flying = [inner.T @ R @ inner for R in solution.flying]
        exponent = int(np.frexp(max(np.abs(Q).max() for Q in (*touching, *flying)))[1])
        multipliers = np.ldexp(solution.multipliers / self.T[-1, -1] ** 2, -exponent)
        weights = dict(zip(_first(self.named[1]), multipliers, strict=True))
        every = np.array([weights[other] for other in self.named[1].values()])
        top = int(d.max())
        for bits in digits(FEWEST_BITS):
            log2 = bits + 2 * top
            sets = []
            for matrices, named, shifts in (
                (touching, self.named[0], top - d),
                (flying, self.named[1], top - d[:-1]),
            ):
                rounded = (round_form(Q, shifts, bits - exponent) for Q in matrices)
                own = dict(zip(_first(named), rounded, strict=True))
                sets.append(tuple((name, own[other]) for name, other in named.items()))
            lambdas = numerators(every, log2 - 2 * int(d[-1]))
            # The function of a state is that of the mode that takes the next step.
            nodes = [Node(CONTACT, Q) for _, Q in sets[0]] + [Node(FREE, R) for _, R in sets[1]]
            edges = (Arc(k, name, None) for k, (name, _) in enumerate((*sets[0], *sets[1])))
            lost = (Multiplier(LOST, value, k) for k, value in enumerate(lambdas, len(sets[0])))
            yield FormsOnGraph(
                tuple(nodes), max(log2, 0), claim, multipliers=tuple(lost), edges=tuple(edges)
            )


def _first(named: dict[str, str]) -> list[str]:
    """Return those that stand for themselves, in order."""
    return [name for name, other in named.items() if name == other]


def search_conewise_modes(family: Family) -> Candidates[FormsOnGraph]:
    """Search for the functions; then, if asked to, raise the rate.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    time = family.system.time
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    program = ConewiseModeProgram(family)
    if not program.is_finite:
        return OUT_OF_RANGE
    allowance = family.allowance.part(SHARE)
    allowance.require(*program.cost())
    first = program.solve(rate_at(0.0, family.limit, time), allowance)
    if first is None:
        return NO_MARGIN
    if family.optimize_rate:
        for solution, claim in fastest_first(program.solve, family.limit, time, allowance):
            for evidence in program.roundings(solution, claim):
                yield Candidate(evidence, "found with the largest decay rate")
    for claim in claims(1.0, program.own_rate(first), time):
        for evidence in program.roundings(first, claim):
            yield Candidate(evidence)
    return None
