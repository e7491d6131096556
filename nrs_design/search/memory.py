"""Forms that remember the last steps: a node for each word of places (untrusted).

Such a graph is path-complete for words of any length (Ahmadi, Jungers, Parrilo and Roozbehani, SIAM
Journal on Control and Optimization 52, 2014, section 6); under rules its words are those that the
rules allow (Lee and Dullerud, Automatica 42, 2006; Philippe, Essick, Dullerud and Jungers,
Automatica 72, 2016). The longer the words, the nearer to the truth is what their forms show.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import MAX_MONOMIALS, MAX_SETS, MODES, Arc, Node
from nrs_design.proof.steps import Stays
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import balance
from nrs_design.search.candidates import OUT_OF_RANGE, Candidates
from nrs_design.search.drawing import Drawing
from nrs_design.search.family import Family
from nrs_design.search.forms import FormsProgram
from nrs_design.search.graphs import (
    ANY_RATE,
    GROWS,
    left_modes,
    lifted_coordinates,
    limit_of_cycles,
)
from nrs_design.search.polynomial import PER_CHECK, form_sizes
from nrs_design.search.rates import POLYNOMIAL, propose
from nrs_design.search.sdp import program_cost
from nrs_design.work import Cost

# The check follows sets of nodes, of which there are as many as words of any length up to that of
# the memory.
MOST_WORDS = MAX_SETS // 2
# A longer memory than this, or than one of this many edges, is not drawn.
LONGEST, MOST_EDGES = 24, 2048

Word = tuple[str, ...]


def words(system: SwitchedSystem, length: int) -> list[Word] | None:
    """Return the words of places of so many letters; None for too many."""
    after = following(system)
    found: list[Word] = [(name,) for name in after]
    for _ in range(length - 1):
        longer = ((*word, name) for word in found for name in after[word[-1]])
        found = list(islice(longer, MOST_WORDS + 1))
    return found if 0 < len(found) <= MOST_WORDS else None


def count_words(system: SwitchedSystem, length: int) -> tuple[int, int] | None:
    """Return how many words there are of so many letters, and of one more; None for too many."""
    if length > LONGEST or (found := words(system, length)) is None:
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
    """Draw a node for each word of so many steps; the degree is half that of the forms.

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
    own = balance(np.array([mode.A.floats() for mode in system.modes]))
    coordinates = (lifted_coordinates(own, degree),) * len(found)
    return Drawing(system, graph, tuple(range(len(found))), coordinates)


def memories(system: SwitchedSystem, degree: int = 1, first: int = 1) -> dict[int, Cost]:
    """Return how many steps forms of degree 2d may remember, with what that takes.

    In discrete time, and no fewer steps than `first`.
    """
    found = dict[int, Cost]()
    order, own, forms = form_sizes(system.order, degree)
    names = [mode.name for mode in system.modes]
    if not all(any(name in ends for ends in following(system).values()) for name in names):
        # A mode that nothing leads to ends no word, and a run may begin in it.
        return found
    for length in range(first, LONGEST + 1 if order <= MAX_MONOMIALS else 0):
        if (counts := count_words(system, length)) is None:
            return found
        nodes, edges = counts
        shared = own * nodes + 1
        cones = [(order, own)] * (2 * nodes) + [(order, 2 * own + forms)] * edges
        cost = program_cost(shared + forms * edges, shared, cones)
        checked = cost.work + 2 * edges * PER_CHECK * order**2
        found[length] = replace(cost, work=checked)
    return found


def quadratic_memories(system: SwitchedSystem) -> dict[int, Cost]:
    """Return the same of quadratic forms; under rules, those of the modes remember one step."""
    return memories(system, first=1 if system.switching.is_arbitrary else 2)


def quartic_memories(system: SwitchedSystem) -> dict[int, Cost]:
    """Return the same of forms of degree 4."""
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
