"""Graphs of systems, and searches for rates of their forms (untrusted)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import MODES, Arc, Multiplier, Node
from nrs_design.proof.lift import monomials
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.spectrum import is_stable
from nrs_design.proof.steps import FREE, ROUNDING, Stays
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.balance import balance, mean_norm, round_coordinates, separating
from nrs_design.search.branches import (
    StepGraph,
    best_words,
    matrices_of_kinds,
    round_nodes,
    turns_graph,
)
from nrs_design.search.drawing import Drawing, FormCoordinates
from nrs_design.search.family import Family, free_motions, separating_coordinates, stand_ins
from nrs_design.search.forms import FormsProgram
from nrs_design.search.graph import Graph, growing_cycles
from nrs_design.search.polynomial import (
    conewise_cost,
    family_cost,
    functions_cost,
    monomial_weights,
    work_of_checks,
)
from nrs_design.search.rates import POLYNOMIAL, Rates, at_own_rate, digits, propose, round_rate
from nrs_design.search.stays import round_stays
from nrs_design.search.work import Cost

Array = NDArray[np.float64]
Exponents = NDArray[np.int64]

# Share of the slowest decay that is claimed of one state.
BACK_OFF = Fraction(1999, 2000)
# Digits where stays are enclosed.
BITS_OF_STAYS = (12, 32, 60)
# Work for each edge, to have it in floating point.
PER_EDGE = 5e-5
# Programs take the steps of a system in units that suit this rate.
ANY_RATE = Fraction(1)
# Largest contraction of the mean of all modes of a round, which may grow.
KEPT = 0.99
# Largest number of checked conditions with rounding errors.
MOST_ROUNDED = 250
# Largest number of stays of a stable mode that have an edge each.
FEW_STAYS = 64
# Rules for misses with more states start with shared forms; after LONG_AGO steps, the time of the
# last miss is ignored.
FEW_STATES, LONG_AGO = 12, 2
# Share of the remaining budget for words that limit the rate.
WORDS = 0.1
# Relative resolution of the largest rate where it is not requested.
ROUGH = 0.3
GROWS = "not looked for: the state grows along a cycle of modes"
# The lengths of a stay in continuous time, times the size of the mode, that are nearly one.
NARROW_STAYS = 0.5


def search_conewise_modes(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a form for each mode, in contact and in free motion."""
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    # Simpler functions for maintained contact need the remaining budget.
    allowance = family.allowance.part(0.25)
    nodes = len(family.system.every_mode)
    allowance.require(Cost(PER_EDGE * 2 * nodes**2), f"a graph of {2 * nodes**2} edges")
    drawing = draw_conewise_modes(family)
    if not drawing.is_finite:
        return OUT_OF_RANGE
    own = replace(family, allowance=allowance)
    return (yield from propose(FormsProgram(drawing), own, family.limit, Rates(bits=digits(12))))


def draw_conewise_modes(family: Family) -> Drawing:
    """Draw a node for each mode, in contact and free, which takes its steps to every node."""
    system = family.system
    coordinates = FormCoordinates(family.exponents, separating_coordinates(family))
    flying = FormCoordinates(family.exponents[:-1], coordinates.T[:-1, :-1])
    names = [mode.name for mode in system.every_mode]
    representative = stand_ins(names[: len(system.modes)], family.matrices)
    representative |= stand_ins(names[len(system.modes) :], free_motions(family))
    number = {name: k for k, name in enumerate(dict.fromkeys(representative.values()))}
    contact = {representative[mode.name] for mode in system.modes}
    return Drawing(
        system,
        FormsOnGraph(
            tuple(Node(MODES if k < len(system.modes) else FREE, ()) for k in range(len(names))),
            0,
            ANY_RATE,
            # The mode of the next step selects the form of a state.
            edges=tuple(Arc(k, name, None) for k, name in enumerate(names)),
        ),
        tuple(number[representative[name]] for name in names),
        tuple(coordinates if name in contact else flying for name in number),
    )


def search_periodic_quadratic(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a form for each step of a round, where modes take turns.

    Where the arithmetic rounds, forms that cover that are tried before others, unless there are
    too many conditions to check.
    """
    system, clock = family.system, family.system.clock
    if clock is None:
        return NO_MARGIN
    if not np.isfinite(family.matrices).all():
        return OUT_OF_RANGE
    words = best_words(turns_graph(family, clock), family.allowance.part(WORDS))
    limit, ended = max((growth for _, growth in words), default=0.0), None
    mode_names = [mode.name for mode in system.every_mode]
    kinds = Counter(clock.kind_of(mode_names))
    # At the largest rate itself there is no room for rounding.
    rates = Rates(0.5, resolution=2.0**-7, nearest=0.99, few=True, bits=digits(24))
    for drawing in draw_turns(family, clock):
        if not drawing.is_finite:
            return OUT_OF_RANGE
        form_of_state = drawing.forms[:: len(drawing.forms) // clock.length]
        different = {
            (form_of_state[k], kind, form_of_state[target]) for k, kind, target in clock.turns()
        }
        checked = sum(kinds[kind] for _, kind, _ in different)
        rounds = bool(system.roundings) and checked <= MOST_ROUNDED
        coverings = (True, False) if rounds else (False,)
        ended = yield from propose(FormsProgram(drawing), family, limit, rates, coverings)
    return ended


def draw_turns(family: Family, clock: Clock) -> Iterator[Drawing]:
    """Draw a node for each step of a round, or state of a rule; in free motion it has its form.

    States of a large rule first have a form for all that are alike.
    """
    system, is_unilateral = family.system, family.system.contact is not None
    places = [MODES, FREE] if is_unilateral else [MODES]
    places_of_nodes = [f"{place} {k}" for k in range(clock.length) for place in places]
    graph = graph_of(places_of_nodes, len(system.roundings))
    own = [FormCoordinates(family.exponents, T) for T in _coordinates(family, clock)]
    if not clock.is_round and clock.length > FEW_STATES:
        representative = _alike(clock)
        number = {one: i for i, one in enumerate(dict.fromkeys(representative))}
        forms = tuple(number[one] for one in representative for _ in places)
        coordinates = tuple(own[representative.index(one)] for one in number)
        yield Drawing(system, graph, forms, coordinates)
    forms = tuple(k for k in range(clock.length) for _ in places)
    yield Drawing(system, graph, forms, tuple(own))


def _alike(clock: Clock) -> list[tuple[int, int]]:
    """Return for each state how many misses may follow at once, and how long ago the last one was.

    Beyond `LONG_AGO` steps, that makes no difference.
    """
    ago = [LONG_AGO] * clock.length
    for _ in range(LONG_AGO):
        for state, missed, target in clock.turns():
            ago[target] = min(ago[target], 0 if missed else ago[state] + 1)
    found = []
    for state, last in enumerate(ago):
        misses, successor = 0, clock.after(state, 1)
        while successor is not None and misses < clock.length:
            misses, successor = misses + 1, clock.after(successor, 1)
        found.append((misses, last))
    return found


def _coordinates(family: Family, clock: Clock) -> Array:
    """Return the T of every step, which leave the deflection alone.

    The part of the state that a mean mode keeps until rest is round in them.
    """
    means = np.array([own.mean(axis=0) for own in matrices_of_kinds(family, clock)])
    find_coordinates = round_coordinates if family.system.contact is None else separating
    names = [*map(str, clock.kinds)]
    return round_nodes(StepGraph.of_clock(clock, names, means, clock.kinds), find_coordinates)


def search_modes(family: Family, degree: int = 1) -> Candidates[FormsOnGraph]:
    """Search for a form of degree 2d for each mode, under its rules of switching.

    Modes may be of any sizes; d is beyond 1 in discrete time only.
    """
    system, allowance = family.system, family.allowance
    cost, description = functions_cost(system, degree)
    checked = replace(cost, work=cost.work + work_of_checks(system, degree))
    allowance.require(checked, f"{description}, with the exact check of what it finds,")
    always = family.optimize_rate or not family.stand_ins()
    limit, ended = limit_of_cycles(family), None
    if limit <= 0 if system.time is Time.CONTINUOUS else limit >= 1:
        return GROWS
    for drawing in draw_each_mode(family, degree):
        if not drawing.is_finite:
            return OUT_OF_RANGE
        rates = Rates(nearest=0.999, bits=digits(6))
        assert drawing.graph.stays is not None
        if drawing.graph.stays.leaving and system.time is Time.CONTINUOUS:
            # Enclosures take time: few attempts, and wider gaps.
            rates = Rates(nearest=0.9, few=True, bits=BITS_OF_STAYS)
        if not family.optimize_rate:
            rates = replace(rates, resolution=ROUGH)
        rates = replace(rates, always=always, words="found")
        ended = yield from propose(FormsProgram(drawing), family, limit, rates)
    return ended


def limit_of_cycles(family: Family) -> float:
    """Return the rate that no form can beat: that of the worst cycle found, under rules.

    Without rules, that of the modes that need never be left is near enough.
    """
    system = family.system
    if not system.is_uniform or system.switching.is_arbitrary or system.switching.fixed_ends:
        return family.limit
    matrices = np.array([mode.A.floats() for mode in system.modes])
    if system.time is Time.DISCRETE:
        steps = StepGraph.of(system, matrices) if np.isfinite(matrices).all() else None
        allowance = family.allowance.part(WORDS)
        words = () if steps is None else best_words(steps, allowance, family.limit)
        return max((growth for _, growth in words), default=family.limit)
    if len(system.lasting_modes()) == len(system.modes):
        return family.limit
    graph = Graph.of(system, matrices)
    cycles = growing_cycles(graph, family.allowance)
    return min((-float(graph.growth(*cycle)) for cycle in cycles), default=family.limit)


def draw_each_mode(family: Family, degree: int) -> Iterator[Drawing]:
    """Draw a node for each mode, as a place of its own.

    What is drawn next shows every stay of the modes that have a longest one, which asks for less,
    but takes longer; in coordinates in which what a mean signal keeps is round.
    """
    system = family.system
    representative = family.stand_ins() or {mode.name: mode.name for mode in system.modes}
    number = {name: k for k, name in enumerate(dict.fromkeys(representative.values()))}
    matrices = {mode.name: np.array(mode.A.floats()) for mode in system.modes}
    common_exponents = [balance(np.array(list(matrices.values())))] if system.is_uniform else []
    coordinates = []
    for name in number:
        d = common_exponents[0] if common_exponents else balance(matrices[name][None])
        coordinates.append(lifted_coordinates(d, degree))
    stays = system.stays()
    leaving = left_modes(system)
    forms = tuple(number[representative[mode.name]] for mode in system.modes)
    nodes = tuple(Node(mode.name, ()) for mode in system.modes)
    graph = FormsOnGraph(nodes, 0, ANY_RATE, degree, stays=Stays(leaving))
    drawing = Drawing(system, graph, forms, tuple(coordinates))
    yield drawing
    stay_modes = tuple(mode.name for mode in system.modes if stays[mode.name].longest is not None)
    if stay_modes and system.time is Time.CONTINUOUS and drawing.is_finite:
        own = round_stays(system, stay_modes)
        graph = replace(graph, stays=Stays(stay_modes))
        yield replace(drawing, graph=graph, coordinates=tuple(own[name] for name in number))


def search_together(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a form for all modes, in contact and free.

    Where the arithmetic rounds, forms that cover that are tried before others.
    """
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    is_unilateral = family.system.contact is not None
    covered = (True,) if family.system.roundings else ()
    coverings = (*covered, False) if is_unilateral or not covered else covered
    drawing = draw_together(family, 1, lost=is_unilateral)
    if not drawing.is_finite:
        return OUT_OF_RANGE
    program = FormsProgram(drawing)
    return (yield from propose(program, family, family.limit, Rates(share=0.5), coverings))


def search_by_lmi(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a form for all modes, in kept contact, whatever the arithmetic rounds."""
    drawing = draw_balanced(family)
    if not drawing.is_finite:
        return OUT_OF_RANGE
    program = FormsProgram(drawing)
    if not family.optimize_rate:
        # The mean of the modes' own norms often does, and takes no solver.
        with suppress(np.linalg.LinAlgError):
            Q = mean_norm(family.matrices, family.system.time)
            yield from at_own_rate(program, program.solution_of([Q]), family, digits())
    return (yield from propose(program, family, family.limit, Rates(share=0.5)))


def decide_one_state(family: Family) -> Candidates[FormsOnGraph]:
    """Take ``V(x) = x^2``, at a rate computed exactly: modes may be nearer to 1 than floats are."""
    system = family.system
    numbers = [mode.A.fractions()[0][0] for mode in system.modes]
    claimed = BACK_OFF * -max(numbers)
    if system.time is Time.DISCRETE:
        claimed = 1 - BACK_OFF * (1 - max(map(abs, numbers)))
    rate = round_rate(claimed, system.time)
    yield Candidate(FormsOnGraph((Node(MODES, ((1,),)),), 0, rate))
    return None


def search_polynomial(family: Family, degree: int) -> Candidates[FormsOnGraph]:
    """Search for a polynomial of degree 2d that all modes share."""
    family.allowance.require(*family_cost(family.system, degree))
    program = FormsProgram(draw_together(family, degree))
    return (yield from propose(program, family, family.limit, POLYNOMIAL))


def search_conewise_polynomial(family: Family, degree: int) -> Candidates[FormsOnGraph]:
    """Search for a polynomial of degree 2d for contact and free motion."""
    family.allowance.require(*conewise_cost(family.system, degree))
    program = FormsProgram(draw_together(family, degree, lost=True))
    return (yield from propose(program, family, family.limit, POLYNOMIAL))


def lifted_coordinates(d: Exponents, degree: int) -> FormCoordinates:
    """Return coordinates of monomials, in which forms have a nearly orthonormal basis."""
    if degree > 1:
        basis = np.array(monomials(len(d), degree), dtype=np.int64)
        d = np.asarray(basis @ d - monomial_weights(len(d), degree))
    return FormCoordinates(d, np.eye(len(d)))


def draw_together(family: Family, degree: int, *, lost: bool = False) -> Drawing:
    """Draw a node for all modes, and in free motion the same form without the deflection.

    `lost`: contact is lost and made.
    """
    system = family.system
    places = [MODES, FREE] if lost else [MODES]
    # A form of monomials has no multipliers.
    graph = graph_of(places, len(system.roundings) if degree == 1 else 0, degree)
    own = lifted_coordinates(family.exponents, degree)
    if degree == 1:
        own = FormCoordinates(family.exponents, separating_coordinates(family))
    return Drawing(system, graph, (0,) * len(places), (own,))


def draw_balanced(family: Family) -> Drawing:
    """Draw a node for all modes, in balanced states, which is nearer to the best of few modes."""
    own = FormCoordinates(family.exponents, np.eye(len(family.exponents)))
    return Drawing(family.system, graph_of([MODES], 0), (0,), (own,))


def graph_of(places: Sequence[str], roundings: int, degree: int = 1) -> FormsOnGraph:
    """Return a graph with a node at every place, and multipliers for so many roundings."""
    nodes = tuple(Node(place, ()) for place in places)
    multipliers = tuple(Multiplier(f"{ROUNDING} {k + 1}", 0) for k in range(roundings))
    return FormsOnGraph(nodes, 0, ANY_RATE, degree, multipliers=multipliers)


def left_modes(system: SwitchedSystem) -> tuple[str, ...]:
    """Return the modes of which every stay is shown.

    That asks for less than a decrease, but takes longer.
    """
    stays = system.stays()

    def is_left(mode: Mode) -> bool:
        stay = stays[mode.name]
        if stay.longest is None:
            return False
        width = float(stay.longest - stay.shortest)
        is_narrow = width < FEW_STAYS
        if system.time is Time.CONTINUOUS:
            # Stays that are nearly of one length are enclosed well.
            is_narrow = width * float(np.linalg.norm(mode.A.floats())) <= NARROW_STAYS
        return is_narrow or not is_stable(mode.A, system.time)

    return tuple(mode.name for mode in system.modes if is_left(mode))
