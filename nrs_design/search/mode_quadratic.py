"""Search for one function per mode under a dwell time, a transition graph and resets.

Quadratic functions, or in discrete time polynomials: quadratic ones of the monomials of a degree,
with a form that vanishes identically added to every decrease.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise, product
from math import comb

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import Node
from nrs_design.proof.lift import monomials
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.spectrum import is_stable
from nrs_design.proof.steps import Stays
from nrs_design.proof.switching import Edge, Stay
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import balance, scale_states
from nrs_design.search.candidates import NO_MARGIN, Candidate, Candidates
from nrs_design.search.decay import fastest_first
from nrs_design.search.family import Family
from nrs_design.search.lifted import lift_system, monomial_weights, products, vanishing_basis
from nrs_design.search.lmi import decreases, time_unit
from nrs_design.search.polynomial import make_vanish
from nrs_design.search.rounding import claims, digits, rate_at, round_form
from nrs_design.search.sdp import (
    begin,
    maximize_margin,
    pack,
    program_cost,
    symmetric_basis,
)
from nrs_design.work import Allowance, Cost

Array = NDArray[np.float64]
Exponents = NDArray[np.int64]

NEAREST = 0.999
FEWEST_BITS = 6
# Numbers of steps that are each shown for a mode that is stable, too.
FEW_STAYS = 64
# Times at which the functions are sought for a mode that must be left, and pieces that are shown.
SAMPLES = 17
PIECES = (32, 256, 1024)
# Enclosures take time: few attempts, and wider gaps.
NEAREST_ENCLOSED = 0.9
FEWEST_BITS_ENCLOSED = 12
# What floating point hides where functions need not decrease, relative to their size.
SLACK = 1e-9
# Work of checking that a form is positive in exact arithmetic, per entry of its matrix.
PER_CHECK = 6e-5


def search_mode_functions(family: Family, degree: int = 1) -> Candidates[FormsOnGraph]:
    """Search for the functions with the largest rate.

    Parameters
    ----------
    family : Family
        The modes, of any sizes, and their switching.
    degree : int
        Half the degree of the functions; beyond 1 for discrete time.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice for another solution.
    """
    system, allowance = family.system, family.allowance
    stand_ins = family.stand_ins() if degree == 1 else {}
    if stand_ins:
        # What is left of the margin covers the differences.
        kept = tuple(mode for mode in system.modes if mode.name in stand_ins.values())
        system = system.with_modes(kept, system.states, system.switching)
    cost, what = functions_cost(system, degree)
    checked = replace(cost, work=cost.work + _work_of_checks(family.system, degree))
    allowance.require(checked, f"{what}, with the exact check of what it finds,")
    problem = _Problem(system, degree, stand_ins)
    first = problem.solve(rate_at(0.0, family.limit, system.time), allowance)
    if first is None:
        return NO_MARGIN
    if stand_ins and not family.optimize_rate:
        for claim in claims(1.0, problem.own_rate(first), system.time):
            for evidence in problem.roundings(first, claim):
                yield Candidate(evidence)
        return None
    few = problem.encloses_stays
    for solution, claim in fastest_first(
        problem.solve,
        family.limit,
        system.time,
        allowance,
        nearest=NEAREST_ENCLOSED if few else NEAREST,
        few=few,
    ):
        for evidence in problem.roundings(solution, claim):
            yield Candidate(evidence)
    return None


def functions_cost(system: SwitchedSystem, degree: int) -> tuple[Cost, str]:
    """Predict what one solution takes, before anything is lifted; say for what."""
    n = max(mode.A.shape[0] for mode in system.modes)
    order = comb(n + degree - 1, degree)
    own = order * (order + 1) // 2
    forms = own - comb(n + 2 * degree - 1, 2 * degree)
    decreases = _count_decreases(system)
    shared = own * len(system.modes) + 1
    cones = [(order, own)] * (2 * len(system.modes)) + [(order, 2 * own + forms)] * decreases
    what = f"a program with {len(cones)} blocks of order {order}"
    return program_cost(shared + forms * decreases, shared, cones), what


def _work_of_checks(system: SwitchedSystem, degree: int) -> float:
    """Predict the work of checking what is found, by us and by the second library."""
    n = max(mode.A.shape[0] for mode in system.modes)
    order = comb(n + degree - 1, degree)
    return 2 * _count_decreases(system) * PER_CHECK * order**2


def _count_decreases(system: SwitchedSystem) -> int:
    counts = {name: _count_stays(system, stay) for name, stay in system.stays().items()}
    return len(system.modes) + sum(counts[edge.source.name] for edge in system.edges())


def _count_stays(system: SwitchedSystem, stay: Stay) -> int:
    if stay.longest is None:
        return 1
    if system.time is Time.CONTINUOUS:
        return SAMPLES
    return int(stay.longest) - int(stay.shortest) + 1


@dataclass(frozen=True)
class _Solution:
    """A matrix for each mode, and a form that vanishes for each decrease."""

    functions: list[Array]
    vanishing: list[Array]


class _Problem:
    """The semidefinite program, in balanced coordinates, for any rate."""

    def __init__(self, system: SwitchedSystem, degree: int, stand_ins: Mapping[str, str]) -> None:
        self.given, self.degree, self.stand_ins = system, degree, stand_ins
        self.cost = functions_cost(system, degree)
        balanced = _balanced(system)
        if degree > 1:
            system = lift_system(system, degree)
            balanced = [_lifted_exponents(d, degree) for d in balanced]
        self.system, self.exponents = system, balanced
        names = {mode.name: k for k, mode in enumerate(system.modes)}
        matrices = [np.array(mode.A.floats()) for mode in system.modes]
        self.matrices = [
            scale_states(A[None], d)[0] for A, d in zip(matrices, self.exponents, strict=True)
        ]
        self.switches = [
            self._switch(names[edge.source.name], names[edge.target.name], edge)
            for edge in system.edges()
        ]
        self.stays = list(system.stays().values())
        self.leaving = [
            self._is_left(mode, stay) for mode, stay in zip(system.modes, self.stays, strict=True)
        ]

    @property
    def encloses_stays(self) -> bool:
        """Whether the checker will enclose all the times that a mode may stay active."""
        return any(self.leaving) and self.system.time is Time.CONTINUOUS

    def _switch(self, i: int, j: int, edge: Edge) -> tuple[int, int, Array]:
        """Return an edge with its reset map in balanced coordinates."""
        G = np.eye(len(self.matrices[i])) if edge.map is None else np.array(edge.map.floats())
        return i, j, np.ldexp(G, self.exponents[i][None, :] - self.exponents[j][:, None])

    def _is_left(self, mode: Mode, stay: Stay) -> bool:
        """Tell whether to show every stay, which asks for less than a decrease, but for longer."""
        if stay.longest is None:
            return False
        few = stay.longest - stay.shortest < FEW_STAYS and self.system.time is Time.DISCRETE
        return few or not is_stable(mode.A, self.system.time)

    def solve(self, rate: float, allowance: Allowance) -> _Solution | None:
        """Maximize the margin for a rate; None if it is not positive."""
        begun = begin(allowance, *self.cost)
        sizes = [len(A) for A in self.matrices]
        bases, forms = [symmetric_basis(n) for n in sizes], self._vanishing_forms()
        wanted = list(self._decreases(bases, rate**self.degree))
        widths = [len(basis) for basis in bases] + [len(forms[i]) for i, _, _ in wanted]
        starts = np.concatenate([[0], np.cumsum(widths)])
        columns = [slice(a, b) for a, b in pairwise(starts)]
        rows, offsets, cones = [], [], []

        def add_cone(
            n: int, parts: list[tuple[slice, Array]], margin: float, constant: float
        ) -> None:
            block = np.zeros((n * (n + 1) // 2, int(starts[-1]) + 1))
            for place, images in parts:
                block[:, place] -= pack(images).T
            block[:, -1] = margin * pack(np.eye(n))
            rows.append(block)
            offsets.append(constant * pack(np.eye(n)))
            cones.append(n)

        for k, basis in enumerate(bases):
            add_cone(sizes[k], [(columns[k], -basis)], 0.0, 1.0)
            add_cone(sizes[k], [(columns[k], basis)], 1.0, 0.0)
        for k, (i, parts, strict) in enumerate(wanted):
            images = [(columns[j], part) for j, part in parts]
            images.append((columns[len(bases) + k], forms[i]))
            add_cone(sizes[i], images, 1.0 if strict else 0.0, 0.0)
        x = maximize_margin(np.vstack(rows), np.concatenate(offsets), cones, begun)
        if x is None or x[-1] <= 0:
            return None
        spans = bases + [forms[i] for i, _, _ in wanted]
        found = [np.tensordot(x[c], span, axes=1) for c, span in zip(columns, spans, strict=True)]
        return _Solution(found[: len(bases)], found[len(bases) :])

    def own_rate(self, solution: _Solution) -> float:
        """Return the contraction per step that quadratic functions show, each stay being a step.

        Parameters
        ----------
        solution : _Solution
            In discrete time, without rules.
        """
        least = 1.0
        for i, parts, _ in self._decreases(solution.functions, 1.0):
            inverse = np.linalg.inv(np.linalg.cholesky(solution.functions[i]))
            form = inverse @ np.sum([part for _, part in parts], axis=0) @ inverse.T
            least = min(least, float(np.linalg.eigvalsh(form)[0]))
        return float(np.sqrt(max(1.0 - least, 0.0)))

    def _decreases(
        self, functions: list[Array], rate: float
    ) -> Iterator[tuple[int, list[tuple[int, Array]], bool]]:
        """Yield what must be positive, in the order of `FormsOnGraph.edges_in_time`.

        Each as the index of its mode, what it takes from the functions of which modes, and whether
        it must be positive definite.
        """
        unit = min(time_unit(A, self.system.time) for A in self.matrices)
        scaled_rate = float(np.ldexp(rate, unit))
        for k, A in enumerate(self.matrices):
            if not self.leaving[k]:
                scaled = np.ldexp(A, unit)
                yield (
                    k,
                    [(k, decreases(scaled, functions[k], self.system.time, scaled_rate))],
                    True,
                )
        flows = [self._flows(k, rate) for k in range(len(self.matrices))]
        for i, j, G in self.switches:
            strict = self.stays[i].shortest > 0 or self.leaving[i]
            for flow in flows[i]:
                jump = G @ flow
                yield i, [(i, functions[i]), (j, -jump.T @ functions[j] @ jump)], strict

    def _vanishing_forms(self) -> list[Array]:
        """Return for each mode an orthonormal basis of the forms that vanish identically."""
        if self.degree == 1:
            return [np.zeros((0, len(A), len(A))) for A in self.matrices]
        return [
            vanishing_basis(mode.A.shape[0], self.degree, -d)
            for mode, d in zip(self.given.modes, self.exponents, strict=True)
        ]

    def _flows(self, mode: int, rate: float) -> list[Array]:
        """Return the state transitions over the stays that count, weighted by the rate."""
        from scipy.linalg import expm

        A, stay = self.matrices[mode], self.stays[mode]
        first, last = float(stay.shortest), float(stay.shortest)
        if self.leaving[mode] and stay.longest is not None:
            last = float(stay.longest)
        if self.system.time is Time.CONTINUOUS:
            times = np.linspace(first, last, SAMPLES if last > first else 1)
            return [np.asarray(expm((A + rate * np.eye(len(A))) * time)) for time in times]
        steps = range(int(first), int(last) + 1)
        return [np.asarray(np.linalg.matrix_power(A / rate, k)) for k in steps]

    def roundings(self, solution: _Solution, claim: Fraction) -> Iterator[FormsOnGraph]:
        """Yield all functions in integers over one denominator."""
        unit = int(np.frexp(max(np.abs(Q).max() for Q in solution.functions))[1])
        few = self.encloses_stays
        bits_tried = digits(FEWEST_BITS_ENCLOSED if few else FEWEST_BITS, few=few)
        for pieces, bits in product(PIECES if few else (1,), bits_tried):
            rounded = [_rounded(Q, bits - unit) for Q in solution.functions]
            if bits != bits_tried[-1] and not self._seems_to_decrease(rounded, float(claim)):
                continue
            graph = self._integers(solution.functions, bits, unit, claim, pieces)
            yield self._with_vanishing(graph, solution, rounded) if self.degree > 1 else graph

    def _seems_to_decrease(self, functions: list[Array], rate: float) -> bool:
        """Tell in floating point whether functions are worth the time of the exact check."""
        if self.degree > 1:
            return True
        for i, parts, strict in self._decreases(functions, rate):
            values = np.linalg.eigvalsh(np.sum([part for _, part in parts], axis=0))
            if values[0] < (0.0 if strict else -SLACK * np.abs(functions[i]).max()):
                return False
        return True

    def _with_vanishing(
        self, graph: FormsOnGraph, solution: _Solution, rounded: list[Array]
    ) -> FormsOnGraph:
        """Add the forms that vanish, as integers to the unit of each of the exact decreases."""
        floats = self._decreases(rounded, float(graph.rate) ** self.degree)
        edges = graph.edges_in_time(self.given)
        vanishing = []
        for (i, parts, _), (a, step, b), N in zip(floats, edges, solution.vanishing, strict=True):
            form = graph.inequality(step, a, b, self.given)
            d, decrease = self.exponents[i], np.sum([part for _, part in parts], axis=0)
            k = int(np.abs(np.diag(decrease)).argmax())
            factor = Fraction(form[k][k]) / Fraction(float(decrease[k, k]) or 1.0)
            factor *= Fraction(4) ** int(d[k])
            integers = [
                [
                    round(factor * Fraction(float(v)) / Fraction(2) ** int(a + b))
                    for b, v in zip(d, row, strict=True)
                ]
                for a, row in zip(d, N, strict=True)
            ]
            variables = self.given.modes[i].A.shape[0]
            vanishing.append(make_vanish(integers, products(variables, self.degree)))
        return replace(graph, vanishing=tuple(tuple(map(tuple, N)) for N in vanishing))

    def _integers(
        self, functions: list[Array], bits: int, unit: int, rate: Fraction, pieces: int
    ) -> FormsOnGraph:
        top = max(int(d.max()) for d in self.exponents)
        rounded = []
        for mode, Q, d in zip(self.system.modes, functions, self.exponents, strict=True):
            rounded.append((mode.name, round_form(Q, top - d, bits - unit)))
        if self.stand_ins:
            own = dict(rounded)
            rounded = [(name, own[other]) for name, other in self.stand_ins.items()]
        names = (mode.name for mode in self.system.modes)
        leaving = tuple(name for name, left in zip(names, self.leaving, strict=True) if left)
        nodes = tuple(Node(name, Q) for name, Q in rounded)
        stays = Stays(leaving, pieces)
        return FormsOnGraph(nodes, max(0, bits + 2 * top), rate, self.degree, stays=stays)


def _rounded(Q: Array, bits: int) -> Array:
    """Round to so many bits after the binary point, in floating point."""
    return np.asarray(np.ldexp(np.rint(np.ldexp((Q + Q.T) / 2, bits)), -bits))


def _balanced(system: SwitchedSystem) -> list[Exponents]:
    """Return balancing exponents for each mode; the same for all where they share their states."""
    matrices = [np.array(mode.A.floats()) for mode in system.modes]
    if system.is_uniform:
        return [balance(np.array(matrices))] * len(matrices)
    return [balance(A[None]) for A in matrices]


def _lifted_exponents(exponents: Exponents, degree: int) -> Exponents:
    """Return the exponents of monomials, in a nearly orthonormal basis of forms."""
    basis = np.array(monomials(len(exponents), degree), dtype=np.int64)
    return np.asarray(basis @ exponents - monomial_weights(len(exponents), degree))
