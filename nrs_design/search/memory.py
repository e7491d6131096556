"""Forms with a memory of the last steps: a node for each sequence of places (untrusted).

Such a graph is path-complete for words of any length (Ahmadi, Jungers, Parrilo and Roozbehani, SIAM
Journal on Control and Optimization 52, 2014, section 6); under rules its words are those that the
rules allow (Lee and Dullerud, Automatica 42, 2006; Philippe, Essick, Dullerud and Jungers,
Automatica 72, 2016). The longer the words, the nearer to the truth is what their forms show.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph, GrowingSequence
from nrs_design.proof.evidence.graph import MAX_MONOMIALS, MAX_SETS, MODES, Arc, Node
from nrs_design.proof.steps import Stays
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import OUT_OF_RANGE, Candidates
from nrs_design.search.balance import balance, round_coordinates
from nrs_design.search.branches import StepGraph, best_words
from nrs_design.search.drawing import Drawing, Solution
from nrs_design.search.family import Family
from nrs_design.search.forms import FormsProgram
from nrs_design.search.graphs import (
    ANY_RATE,
    GROWS,
    left_modes,
    lifted_coordinates,
    limit_of_cycles,
)
from nrs_design.search.period import NOTHING_GROWS, powers
from nrs_design.search.polynomial import PER_CHECK, form_sizes, graph_cost
from nrs_design.search.rates import POLYNOMIAL, propose
from nrs_design.search.work import Allowance, Cost

# The check follows sets of nodes, one for each sequence up to the length of the memory.
MOST_WORDS = MAX_SETS // 2
# Most steps and edges of a memory.
MOST_STEPS, MOST_EDGES = 24, 2048

Word = tuple[str, ...]
Array = NDArray[np.float64]

# Most steps of a sequence of modes, and work of a program whose forms give the norms.
LONGEST, WORK = 400, 0.1
# Resolution of the least growth of forms, relative to its distance from the growth of a word.
SHARE, GROWTH_TOLERANCE = 0.2, 1e-4
HALVINGS = 12
# Upper bounds of the growth that are tried in turn.
BOUNDS = (1.05, 1.5, 6.0)


def words(system: SwitchedSystem, length: int) -> list[Word] | None:
    """Return all sequences of places of a length; None if there are too many."""
    after = following(system)
    found: list[Word] = [(name,) for name in after]
    for _ in range(length - 1):
        longer = ((*word, name) for word in found for name in after[word[-1]])
        found = list(islice(longer, MOST_WORDS + 1))
    return found if 0 < len(found) <= MOST_WORDS else None


def count_words(system: SwitchedSystem, length: int) -> tuple[int, int] | None:
    """Return the number of sequences, and the number of their extensions; None if too many."""
    if length > MOST_STEPS or (found := words(system, length)) is None:
        return None
    after = following(system)
    edges = sum(len(after[word[-1]]) for word in found)
    return (len(found), edges) if edges <= MOST_EDGES else None


def following(system: SwitchedSystem) -> dict[str, list[str]]:
    """Return the modes that a step may lead to from each one, its own among them."""
    names = [mode.name for mode in system.modes]
    if system.switching.is_arbitrary:
        return dict.fromkeys(names, names)
    left = left_modes(system)
    found = {name: [] if name in left else [name] for name in names}
    for edge in system.edges():
        if edge.target.name not in found[edge.source.name]:
            found[edge.source.name].append(edge.target.name)
    return found


def draw_memory(system: SwitchedSystem, length: int, degree: int = 1) -> Drawing:
    """Draw a node for each sequence of a length; the degree is half that of the forms.

    Without rules, the letter that a step adds is its mode; under rules, the mode that it leads to.
    """
    found, after = words(system, length) or [], following(system)
    number, free = {word: k for k, word in enumerate(found)}, system.switching.is_arbitrary
    arcs = tuple(
        Arc(k, name if free else None, number[*word[1:], name])
        for word, k in number.items()
        for name in after[word[-1]]
        if (*word[1:], name) in number
    )
    graph = FormsOnGraph(
        tuple(Node(MODES if free else word[-1], ()) for word in found),
        0,
        ANY_RATE,
        degree,
        edges=arcs,
        stays=None if free else Stays(left_modes(system)),
    )
    exponents = balance(np.array([mode.A.floats() for mode in system.modes]))
    coordinates = (lifted_coordinates(exponents, degree),) * len(found)
    return Drawing(system, graph, tuple(range(len(found))), coordinates)


def memories(system: SwitchedSystem, degree: int = 1, first: int = 1) -> dict[int, Cost]:
    """Return possible lengths of the memory of forms of degree 2d, with their costs.

    In discrete time, and no fewer steps than `first`.
    """
    found = dict[int, Cost]()
    order, *_ = form_sizes(system.order, degree)
    names = [mode.name for mode in system.modes]
    if not all(any(name in ends for ends in following(system).values()) for name in names):
        # A mode that nothing leads to ends no word, and a run may begin in it.
        return found
    for length in range(first, MOST_STEPS + 1 if order <= MAX_MONOMIALS else 0):
        if (counts := count_words(system, length)) is None:
            break
        edges = counts[1]
        cost, _ = graph_cost(system.order, degree, *counts)
        checked = cost.work + 2 * edges * PER_CHECK * order**2
        found[length] = replace(cost, work=checked)
    return found


def quadratic_memories(system: SwitchedSystem) -> dict[int, Cost]:
    """Return `memories` of quadratic forms; under rules, forms of modes have a memory of one."""
    return memories(system, first=1 if system.switching.is_arbitrary else 2)


def quartic_memories(system: SwitchedSystem) -> dict[int, Cost]:
    """Return `memories` of forms of degree 4."""
    return memories(system, 2) if system.order > 1 else {}


def search_memory(family: Family, length: int, degree: int = 1) -> Candidates[FormsOnGraph]:
    """Search for forms of degree 2d that remember so many steps."""
    cost = memories(family.system, degree)[length]
    family.allowance.require(cost, f"a program for forms that remember {length} steps")
    if not np.isfinite(family.matrices).all():
        return OUT_OF_RANGE
    if (limit := limit_of_cycles(family)) >= 1:
        return GROWS
    drawing = draw_memory(family.system, length, degree)
    if not drawing.is_finite:
        return OUT_OF_RANGE
    return (yield from propose(FormsProgram(drawing), family, limit, POLYNOMIAL))


def search_quartic_memory(family: Family, length: int) -> Candidates[FormsOnGraph]:
    """Search for forms of degree 4 that remember so many steps."""
    return (yield from search_memory(family, length, 2))


def least_growth(
    program: FormsProgram, allowance: Allowance, low: float, high: float
) -> tuple[float, Solution] | None:
    """Return nearly the least growth per step that forms show, and them; None above a bound.

    In discrete time: `low` is a growth that some word has, `high` one that forms are to show.
    """
    if (solution := program.solve(high, allowance)) is None:
        return None
    best, bottom = (high, solution), low
    for _ in range(HALVINGS):
        if best[0] - bottom <= max(SHARE * (best[0] - low), GROWTH_TOLERANCE * low):
            break
        middle = (best[0] + bottom) / 2
        found = program.solve(middle, allowance)
        bottom, best = (middle, best) if found is None else (bottom, (middle, found))
    return best


def words_in_norms(
    program: FormsProgram, solution: Solution, allowance: Allowance, floor: float
) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield closed words in the norms of forms, each of which grows more than all before it.

    A word is of edges in the graph of steps of the system, with its growth per step. The program is
    of quadratic forms that `draw_memory` drew. Words that grow by no more than the floor are not
    looked for; those for which work or memory do not suffice end the search.
    """
    system = program.drawing.system
    matrices = np.array([mode.A.floats() for mode in system.modes])
    steps = StepGraph.of(system, matrices)
    if steps is None or steps.has_choice:
        return
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    graph, free = program.drawing.graph, system.switching.is_arbitrary
    if not free and steps.count > len(index):
        return  # The graph of steps counts the steps of a stay, and the forms do not.
    steps_by_ends = zip(steps.sources, steps.targets, steps.modes, strict=True)
    edge_of = {ends: k for k, ends in enumerate(steps_by_ends)}
    places, rows = [node.place for node in graph.nodes], list[tuple[int, int, int]]()
    for a, step, b in graph.edges_in_time(system):
        ends = (0, 0, index[step.mode])
        if not free:
            ends = index[places[a]], index[places[b]], index[places[b]]
        if ends not in edge_of:
            return  # The edge is a stay of several steps.
        rows.append((a, b, edge_of[ends]))
    order = np.argsort([a for a, *_ in rows], kind="stable")
    sources, targets, edges = np.array(rows)[order].T
    maps = np.array([program.every[k].M for k in order])
    no_modes = np.zeros(len(rows), dtype=np.int64)
    memory_graph = StepGraph(
        (), sources, targets, no_modes, no_modes, maps, len(places), has_choice=False
    )
    T = np.array([round_coordinates(Q) for Q in solution.forms])
    for word, growth in best_words(memory_graph, allowance, floor, T, LONGEST):
        yield tuple(int(edges[k]) for k in word), growth


def search_extremal_words(family: Family) -> Candidates[GrowingSequence]:
    """Search for a growing sequence of modes, in the norms of forms with a memory."""
    system, allowance = family.system, family.allowance
    fitting = [length for length, cost in memories(system).items() if cost.work <= WORK]
    if not fitting or not np.isfinite(family.matrices).all():
        return NOTHING_GROWS
    program = FormsProgram(draw_memory(system, fitting[-1]))
    for high in BOUNDS:
        if (found := least_growth(program, allowance, 1.0, high)) is not None:
            break
    else:
        return NOTHING_GROWS
    steps = StepGraph.of(system, np.array([mode.A.floats() for mode in system.modes]))
    if steps is not None:
        for word, growth in words_in_norms(program, found[1], allowance, 1.0):
            sequence, edges = steps.sequence(word)
            yield from powers(system, sequence, edges, growth ** len(word))
    return NOTHING_GROWS
