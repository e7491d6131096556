"""Search for one polynomial for contact and free motion, in continuous time (untrusted).

As for a common polynomial of the modes in contact; beside it, the block of Q without the deflection
has to decrease in the free modes, with vanishing forms of their own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.lift import monomials
from nrs_design.proof.matrix import RationalMatrix, leading
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import NO_MARGIN, Candidate, Candidates
from nrs_design.search.decay import bisect_position
from nrs_design.search.draw import one_form
from nrs_design.search.family import Family
from nrs_design.search.lifted import Lift, lift_family, vanishing_in
from nrs_design.search.polynomial import (
    FEWEST_BITS,
    NEAREST,
    PolynomialSolution,
    decrease_blocks,
    round_vanishing,
    shown_rate,
)
from nrs_design.search.rounding import claims, digits, rate_at, round_form
from nrs_design.search.sdp import begin, maximize_margin, pack, program_cost, symmetric_basis
from nrs_design.work import Allowance, Cost, NotAffordableError

Array = NDArray[np.float64]

# The largest rate is far below that of the slowest mode, so it is bracketed more finely than that
# of a common polynomial, and the function for a little less is rounded.
SMALLEST = 2.0**-10
BACK_OFF = 0.995


@dataclass(frozen=True)
class ConewisePolynomialProgram:
    """The motions in contact and free, lifted to degree d, in coordinates that they share."""

    # system, flying: the exact modes in contact, and the free ones without the deflection.
    system: SwitchedSystem
    flying: SwitchedSystem
    # contact, free: the same, lifted.
    contact: Lift
    free: Lift
    kept: tuple[int, ...]  # The monomials without the deflection

    @classmethod
    def of(cls, family: Family, degree: int) -> ConewisePolynomialProgram:
        """Lift a family in which contact is lost to degree d."""
        system, exponents = family.system, family.exponents
        assert system.contact is not None  # the ladder
        flying = flight(system, system.contact)
        contact = lift_family(system, exponents, degree)
        free = lift_family(flying, exponents[:-1], degree)
        kept = (k for k, term in enumerate(monomials(system.order, degree)) if not term[-1])
        return cls(system, flying, contact, free, tuple(kept))

    def block(self, Q: Array) -> Array:
        """Return what belongs to the monomials without the deflection."""
        return np.asarray(Q[..., self.kept, :][..., self.kept])

    def solve(
        self, rate: float, allowance: Allowance
    ) -> tuple[PolynomialSolution, PolynomialSolution] | None:
        """Maximize the margin at a rate; return Q and its block, each with vanishing forms.

        Raises
        ------
        NotAffordableError
            If work or memory do not suffice.
        """
        begun = begin(allowance, *conewise_cost(self.system, self.contact.degree))
        time, K, k = self.system.time, len(self.contact.exponents), len(self.kept)
        basis = symmetric_basis(K)
        size, own = len(basis), len(self.contact.matrices) * len(self.contact.vanishing)
        width = size + own + len(self.free.matrices) * len(self.free.vanishing) + 1
        bounds = np.zeros((2 * size, width))
        bounds[:size, :size], bounds[size:, :size] = np.eye(size), -np.eye(size)
        touching = decrease_blocks(self.contact, basis, time, rate, size, width)
        inner = self.block(basis)
        flying = decrease_blocks(self.free, inner, time, rate, size + own, width)
        rows = np.vstack([bounds, *touching, *flying])
        offset = np.zeros(len(rows))
        offset[:size] = pack(np.eye(K))
        cones = [K] * (2 + len(touching)) + [k] * len(flying)
        x = maximize_margin(rows, offset, cones, begun)
        if x is None or x[-1] <= 0:
            return None
        Q = np.tensordot(x[:size], basis, axes=1)
        return (
            PolynomialSolution(Q, vanishing_in(self.contact, x[size : size + own])),
            PolynomialSolution(self.block(Q), vanishing_in(self.free, x[size + own : -1])),
        )

    def roundings(
        self, solution: tuple[PolynomialSolution, PolynomialSolution], limit: float
    ) -> Iterator[FormsOnGraph]:
        """Yield roundings to integers at rates just below the one that a solution shows itself."""
        touching, flying = solution
        time, degree = self.system.time, self.contact.degree
        shown = shown_rate(self.contact, touching, time), shown_rate(self.free, flying, time)
        lowest = int(self.contact.exponents.min())
        normalized = int(np.frexp(np.abs(touching.Q).max())[1])
        Q_exponents = self.contact.exponents - lowest
        for claim in claims(1.0, min(*shown, limit), time, NEAREST):
            for bits in digits(FEWEST_BITS):
                left = bits - normalized
                own = round_vanishing(self.system, self.contact, touching, claim, left, lowest)
                free = round_vanishing(self.flying, self.free, flying, claim, left, lowest)
                yield one_form(
                    self.system,
                    round_form(touching.Q, Q_exponents, left),
                    max(0, bits - 2 * lowest),
                    claim,
                    degree,
                    vanishing=own + free,
                    lost=True,
                )


def flight(system: SwitchedSystem, contact: Contact) -> SwitchedSystem:
    """Return the free modes as a family of its own, in all states but the deflection."""
    modes = tuple(
        Mode(mode.name, RationalMatrix(tuple(leading(mode.A.numerators)), mode.A.denominator))
        for mode in contact.free
    )
    return system.with_modes(modes, system.states[:-1], system.switching)


def search_conewise_polynomial(family: Family, degree: int) -> Candidates[FormsOnGraph]:
    """Search for a polynomial of degree 2d, and a large rate if asked to.

    Parameters
    ----------
    family : Family
        The modes, of a system in which contact is lost.
    degree : int
        The d of a form of degree 2d.
    """
    time, allowance = family.system.time, family.allowance
    allowance.require(*conewise_cost(family.system, degree))
    program = ConewisePolynomialProgram.of(family, degree)
    solution = program.solve(rate_at(0.0, family.limit, time), allowance)
    if solution is None:
        return NO_MARGIN
    if family.optimize_rate and (faster := _faster(family, program)) is not None:
        for evidence in program.roundings(faster, family.limit):
            yield Candidate(evidence, "found with a decay rate near the largest")
    for evidence in program.roundings(solution, family.limit):
        yield Candidate(evidence)
    return None


def _faster(
    family: Family, program: ConewisePolynomialProgram
) -> tuple[PolynomialSolution, PolynomialSolution] | None:
    """Bisect for the largest rate, and solve for one a little below it."""

    def solve(position: float) -> tuple[PolynomialSolution, PolynomialSolution] | None:
        return program.solve(rate_at(position, family.limit, family.system.time), family.allowance)

    best = bisect_position(lambda s: solve(s) is not None, 0.0, SMALLEST)
    try:
        return solve(BACK_OFF * best) if best > 0 else None
    except NotAffordableError:
        return None


def conewise_cost(system: SwitchedSystem, degree: int) -> tuple[Cost, str]:
    """Predict what one solution takes, before anything is lifted; say for what.

    Parameters
    ----------
    system : SwitchedSystem
        In which contact is lost.
    degree : int
        The d of a form of degree 2d.
    """
    assert system.contact is not None  # the ladder
    n, free = system.order, len(system.contact.free)
    order, inner = (comb(m + degree - 1, degree) for m in (n, n - 1))
    shared = order * (order + 1) // 2 + 1
    forms = shared - 1 - comb(n + 2 * degree - 1, 2 * degree)
    flying = inner * (inner + 1) // 2 - comb(n - 1 + 2 * degree - 1, 2 * degree)
    modes = len(system.modes)
    cones = [(order, shared)] * 2 + [(order, shared + forms)] * modes
    cones += [(inner, shared + flying)] * free
    unknowns = shared + modes * forms + free * flying
    return program_cost(unknowns, shared, cones), f"a program in {order} monomials"
