"""The growth per step that signals in discrete time reach, from below and from above.

Divided by a number s, the modes grow by s less per step. So a word that does not decay among the
divided ones shows that some motion grows by s at least, and a function that falls by r bounds every
motion by s r: both are decided by the exact check of the divided system, stable or not.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil
from typing import TypeVar

import numpy as np

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.evidence.growth import Steps
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import counted
from nrs_design.search.acceptance import Candidate, Candidates, first_accepted
from nrs_design.search.branches import StepGraph, best_words
from nrs_design.search.certification import Certification, Limits
from nrs_design.search.family import floats_in_silence
from nrs_design.search.forms import FormsProgram
from nrs_design.search.ladder import Facts
from nrs_design.search.memory import draw_memory, least_growth, memories, words_in_norms
from nrs_design.search.period import powers
from nrs_design.search.rates import digits
from nrs_design.work import Allowance, NotAffordableError

E = TypeVar("E", bound=AbstractEvidence)

# A word is claimed to grow by these shares of what it grows by in floating point, and forms by
# these factors more than they show there.
CLAIMED, CLAIM_BITS = (1 - 1e-8, 1 - 1e-6, 1 - 1e-4), 40
MORE, RATE_BITS = (1 + 1e-5, 1 + 1e-4, 1 + 1e-3), 24
# Modes are divided by so many times the growth of the best word, so that forms are found.
ROOM = Fraction(3, 2)
# Ends that are no farther apart than by this factor are left as they are. A longer memory is used
# where it narrows the gap by this share of it at least.
NEAR, GAIN = 1 + 2e-4, 0.25
# Work for words, for forms without a memory, for those that have one, and for words in their norms.
BUDGET, WITH_MEMORY, IN_NORMS = 10.0, 1.5, 0.5
# The highest degree of forms that remember.
QUARTIC = 4
# Norms for words are those of forms that take this work.
NORMS = 0.1


@dataclass(frozen=True)
class RadiusBounds:
    """The largest growth per step of all signals, between two numbers that are shown exactly."""

    lower: Fraction | None  # Some signal reaches it; None if no word was found
    # That signal, again and again: modes with the number of their steps.
    word: Steps | None
    evidence: AbstractEvidence | None  # That it grows, of modes divided by the lower end
    upper: Fraction | None  # No signal grows by more, but for a constant factor; None if not shown
    method: str | None  # By which rung that was found

    @property
    def gap(self) -> Fraction | None:
        """How far the ends are apart, as a share of the lower one; None without both."""
        if self.lower is None or self.upper is None:
            return None
        return self.upper / self.lower - 1


def bound_radius(found: Certification, limits: Limits) -> RadiusBounds | None:
    """Bound the growth per step of a system in discrete time, whatever its verdict is.

    None in continuous time, for modes of several sizes, and where more acts on the state than
    switching: contact that may be lost, rounding, turns.
    """
    system = found.system
    acting = system.contact, system.flights, system.clock, system.saturation
    if system.time is not Time.DISCRETE or not system.is_uniform or any(acting):
        return None
    if system.roundings:
        return None
    budget = min(limits.budget, BUDGET)
    bounds = RadiusBounds(None, None, None, None, None)
    with floats_in_silence():
        matrices = np.array([mode.A.floats() for mode in system.modes])
        graph = StepGraph.of(system, matrices) if np.isfinite(matrices).all() else None
        if graph is not None:
            words = best_words(graph, Allowance(budget, limits.memory))
            bounds = _with_words(bounds, system, graph, list(words))
    if found.verdict is Verdict.PROVED and found.evidence is not None:
        known = found.evidence.proved_rate(system), found.method
        bounds = replace(bounds, upper=known[0], method=known[1])
    limits = replace(limits, budget=budget, more=False)
    if graph is not None and bounds.lower is not None and Facts.of(system).is_of_words():
        with floats_in_silence():
            bounds = _with_memory(system, graph, bounds, limits)
    return bounds


def _with_words(
    bounds: RadiusBounds,
    system: SwitchedSystem,
    graph: StepGraph,
    words: Sequence[tuple[tuple[int, ...], float]],
) -> RadiusBounds:
    """Raise the lower end to what the best of some words is shown to grow by."""
    for word, growth in reversed(words):
        steps, edges = graph.sequence(word)
        for share in CLAIMED:
            claim = Fraction(round(growth * share * 2**CLAIM_BITS), 2**CLAIM_BITS)
            if not max(0, bounds.lower or 0) < claim < growth:
                continue
            divided = _divided(system, claim)
            radius = (growth / float(claim)) ** len(word)
            evidence, _ = first_accepted(_proposed(powers(divided, steps, edges, radius)), divided)
            if evidence is not None:
                return replace(bounds, lower=claim, word=steps, evidence=evidence)
    return bounds


def _proposed(found: Iterable[Candidate[E]]) -> Candidates[E]:
    yield from found
    return None


def _with_memory(
    system: SwitchedSystem, graph: StepGraph, bounds: RadiusBounds, limits: Limits
) -> RadiusBounds:
    """Bring both ends nearer: by forms that remember more and more, and by words in their norms.

    A program is solved once to see whether it narrows the gap; only then is its best bound sought.
    """
    assert bounds.lower is not None
    allowance, for_words = (
        Allowance(min(limits.budget, work), limits.memory) for work in (WITH_MEMORY, IN_NORMS)
    )
    by, at = bounds.lower * ROOM, float(1 / ROOM)
    best = min(1.0, float(bounds.upper / by)) if bounds.upper else 1.0
    divided, found = _divided(system, by), None
    for length, degree in _by_work(divided, allowance, limits.max_degree or QUARTIC):
        if best <= at * NEAR:
            break
        program = FormsProgram(draw_memory(divided, length, degree))
        try:
            least = least_growth(program, allowance, at, best - GAIN * (best - at))
        except NotAffordableError:
            break
        if least is None:
            continue
        best, found = least[0], (program, length, degree)
        if degree == 1 and memories(divided)[length].work <= NORMS:
            words = words_in_norms(program, least[1], for_words, at * (1 + 1e-7))
            grown = [(word, growth * float(by)) for word, growth in words]
            bounds = _with_words(bounds, system, graph, grown)
            at = max(at, float((bounds.lower or by) / by))
    if found is None:
        return bounds
    return _claimed(bounds, by, best, *found, Allowance(limits.budget, limits.memory))


def _by_work(system: SwitchedSystem, allowance: Allowance, highest: int) -> list[tuple[int, int]]:
    """Return how many steps forms may remember, with half their degree, the cheapest first."""
    degrees = (1, 2) if system.order > 1 and highest >= QUARTIC else (1,)
    every = [
        (cost.work, length, degree)
        for degree in degrees
        for length, cost in memories(system, degree).items()
        if allowance.affords(cost)
    ]
    return [(length, degree) for _, length, degree in sorted(every)]


def _claimed(
    bounds: RadiusBounds,
    by: Fraction,
    rate: float,
    program: FormsProgram,
    length: int,
    degree: int,
    allowance: Allowance,
) -> RadiusBounds:
    """Lower the upper end to what forms with a memory are shown to bound, exactly."""
    for more in MORE:
        claim = Fraction(ceil(rate * more * 2**RATE_BITS), 2**RATE_BITS)
        if claim >= 1 or (bounds.upper is not None and claim * by >= bounds.upper):
            break
        try:
            solution = program.solve(float(claim), allowance)
        except NotAffordableError:
            break
        if solution is None:
            continue
        forms = program.roundings(solution, claim, digits(10))
        candidates = _proposed(map(Candidate, forms))
        if first_accepted(candidates, program.drawing.system)[0] is not None:
            kind = "quadratic" if degree == 1 else "quartic"
            method = f"{kind} with a memory of {counted(length, 'step')}"
            return replace(bounds, upper=claim * by, method=method)
    return bounds


def _divided(system: SwitchedSystem, by: Fraction) -> SwitchedSystem:
    """Return the system with all modes divided by a number."""
    modes = tuple(
        Mode(
            mode.name,
            RationalMatrix.from_rows([[v / by for v in row] for row in mode.A.fractions()]),
        )
        for mode in system.modes
    )
    return replace(system, modes=modes)
