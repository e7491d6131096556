"""The growth per step that signals in discrete time reach, from below and from above.

Divided by a number s, the modes grow by s less per step. So a word that does not decay among the
divided ones shows that some motion grows by s at least, and a function that falls by r bounds every
motion by s r: both are decided by the exact check of the divided system, stable or not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.evidence.growth import Steps
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.branches import best_words
from nrs_design.search.candidates import Candidates
from nrs_design.search.certification import Certification, Limits
from nrs_design.search.certify import certify, first_accepted
from nrs_design.search.family import floats_in_silence
from nrs_design.search.method import Method
from nrs_design.search.period import powers
from nrs_design.search.step_graph import StepGraph
from nrs_design.work import Allowance

# A word is claimed to grow by these shares of what it grows by in floating point.
CLAIMED, CLAIM_BITS = (1 - 1e-8, 1 - 1e-6, 1 - 1e-4), 40
# Modes are divided by so many times the growth of the best word, so that a function is found.
ROOM = (Fraction(3, 2), Fraction(6))
CLOSE = Fraction(101, 100)
# Where the ends are farther apart than by this factor, polynomials of this degree are tried, too.
NEAR, DEGREE = Fraction(1002, 1000), 4
BUDGET = 10.0


@dataclass(frozen=True)
class RadiusBounds:
    """The largest growth per step of all signals, between two numbers that are shown exactly."""

    lower: Fraction | None  # Some signal reaches it; None if no word was found
    # That signal, again and again: modes with the number of their steps.
    word: Steps | None
    evidence: AbstractEvidence | None  # That it grows, of modes divided by the lower end
    upper: Fraction | None  # No signal grows by more, but for a constant factor; None if not shown
    method: str | None  # By which rung that was found


def bound_radius(found: Certification, limits: Limits) -> RadiusBounds | None:
    """Bound the growth per step of a system in discrete time, whatever its verdict is.

    None in continuous time, for modes of several sizes, and where more acts on the state than
    switching: contact that may be lost, rounding, other axes, turns.

    Parameters
    ----------
    found : Certification
        What is known of it.
    limits : Limits
        How far the searches go.
    """
    system = found.system
    acting = system.contact, system.flights, system.clock, system.saturation
    if system.time is not Time.DISCRETE or not system.is_uniform or any(acting):
        return None
    if system.roundings or system.couplings:
        return None
    budget = min(limits.budget, BUDGET)
    lower, word, evidence = _lower(system, Allowance(budget, limits.memory))
    known: tuple[Fraction | None, str | None] = None, None
    if found.verdict is Verdict.PROVED and found.evidence is not None:
        known = found.evidence.proved_rate(system), found.method
    upper, method = _upper(system, lower, known, replace(limits, budget=budget, more=False))
    return RadiusBounds(lower, word, evidence, upper, method)


def _lower(
    system: SwitchedSystem, allowance: Allowance
) -> tuple[Fraction | None, Steps | None, AbstractEvidence | None]:
    """Return what the best word is shown to grow by, and that word."""
    with floats_in_silence():
        matrices = np.array([mode.A.floats() for mode in system.modes])
        graph = StepGraph.of(system, matrices)
        if graph is None or not np.isfinite(matrices).all():
            return None, None, None
        words = list(best_words(graph, allowance))
    for word, growth in reversed(words):
        steps, edges = graph.sequence(word)
        for share in CLAIMED:
            claim = Fraction(round(growth * share * 2**CLAIM_BITS), 2**CLAIM_BITS)
            if not 0 < claim < growth:
                continue
            divided = _divided(system, claim)
            radius = (growth / float(claim)) ** len(word)
            evidence, _ = first_accepted(_proposed(divided, steps, edges, radius), divided)
            if evidence is not None:
                return claim, steps, evidence
    return None, None, None


def _proposed(
    system: SwitchedSystem,
    steps: Steps,
    edges: tuple[int, ...],
    radius: float,
) -> Candidates[AbstractEvidence]:
    yield from powers(system, steps, edges, radius)
    return None


def _upper(
    system: SwitchedSystem,
    lower: Fraction | None,
    best: tuple[Fraction | None, str | None],
    limits: Limits,
) -> tuple[Fraction | None, str | None]:
    """Return the least growth that a function is found to bound, and how; no worse than known."""
    rules = not (system.switching.is_arbitrary or system.switching.fixed_ends)
    higher = Method.MODE_POLYNOMIAL if rules else Method.POLYNOMIAL
    limits = replace(limits, max_degree=DEGREE)
    for method in (Method.MODE_QUADRATIC, higher):
        if best[0] is not None and lower is not None and best[0] <= lower * NEAR:
            break
        for room in ROOM:
            if (found := _shown(system, room * (lower or 1), method, limits)) is not None:
                # What is claimed is off the best by a share of the room.
                closer = _shown(system, found[0] * CLOSE, method, limits)
                better = [item for item in (best, found, closer) if item and item[0] is not None]
                best = min(better, key=lambda item: item[0] or 0)
                break
    return best


def _shown(
    system: SwitchedSystem, by: Fraction, method: Method, limits: Limits
) -> tuple[Fraction, str] | None:
    """Return what the modes divided by a number are shown to grow by, as they are."""
    found = certify(_divided(system, by), method, limits)
    if found.verdict is not Verdict.PROVED or found.evidence is None:
        return None
    rate = found.evidence.proved_rate(found.system)
    return None if rate is None else (rate * by, found.method)


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
