"""Graphs as the searches draw them, from the numbers that they find."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.evidence.graph import FormsOnGraph, Multiplier, Node
from nrs_design.proof.lift import monomials
from nrs_design.proof.steps import CONTACT, COUPLING, FREE, ROUNDING, multiplier_names
from nrs_design.proof.system import SwitchedSystem

Integers = Sequence[int]


def undeflected(Q: Matrix, order: int, degree: int = 1) -> Matrix:
    """Return a form where the last state is zero: the block of the monomials without it.

    Parameters
    ----------
    Q : tuple of tuple of int
        The form.
    order : int
        Number of states.
    degree : int
        Of the monomials.
    """
    kept = [k for k, term in enumerate(monomials(order, degree)) if not term[-1]]
    return tuple(tuple(Q[i][j] for j in kept) for i in kept)


def one_form(
    system: SwitchedSystem,
    Q: Matrix,
    log2: int,
    rate: Fraction,
    degree: int = 1,
    *,
    crossings: Integers = (),
    roundings: Integers = (),
    couplings: Integers = (),
    vanishing: tuple[Matrix, ...] = (),
    lost: bool = False,
) -> FormsOnGraph:
    """Draw one form for all modes, and in free motion the same without the deflection.

    Parameters
    ----------
    system : SwitchedSystem
        That the graph is about.
    Q : tuple of tuple of int
        The form in contact.
    log2 : int
        Q and all multipliers are over two to this power.
    rate : Fraction
        The alpha in 1/s, or rho per step.
    degree : int
        Of the monomials.
    crossings, roundings, couplings : sequence of int
        Multipliers, in the order of the system.
    vanishing : tuple of matrix
        One for each mode, in contact and free.
    lost : bool
        Whether contact is lost and made.
    """
    nodes = [Node(CONTACT, Q)]
    if lost:
        nodes.append(Node(FREE, undeflected(Q, system.order, degree)))
    multipliers = _multipliers(system, crossings, roundings, couplings)
    found = tuple(Multiplier(fact, value) for fact, value in multipliers)
    return FormsOnGraph(tuple(nodes), log2, rate, degree, found, vanishing)


def in_turns(
    system: SwitchedSystem,
    forms: Sequence[Matrix],
    log2: int,
    rate: Fraction,
    crossings: Sequence[Integers] = (),
    roundings: Sequence[Integers] = (),
) -> FormsOnGraph:
    """Draw one form for each step of a round, with the multipliers of each step.

    Parameters
    ----------
    system, log2, rate
        As for `one_form`.
    forms : sequence of matrix
        In contact, in the order of the steps.
    crossings, roundings : sequence of sequence of int
        Multipliers of every step; none where contact is kept, or the arithmetic exact.
    """
    lost, count = system.contact is not None, len(forms)
    nodes, multipliers = [], []
    for k, Q in enumerate(forms):
        nodes.append(Node(f"{CONTACT} {k}", Q))
        if lost:
            nodes.append(Node(f"{FREE} {k}", undeflected(Q, system.order)))
    width = len(nodes) // count
    for k in range(count):
        own = crossings[k] if crossings else (), roundings[k] if roundings else ()
        targets = range((k + 1) % count * width, (k + 1) % count * width + width)
        for fact, value in _multipliers(system, *own, ()):
            multipliers += [Multiplier(fact, value, target) for target in targets]
    return FormsOnGraph(tuple(nodes), log2, rate, multipliers=tuple(multipliers))


def _multipliers(
    system: SwitchedSystem, crossings: Integers, roundings: Integers, couplings: Integers
) -> list[tuple[str, int]]:
    names = multiplier_names(system) if crossings else ()
    return [
        *zip(names, crossings, strict=True),
        *((f"{ROUNDING} {k}", value) for k, value in enumerate(roundings, 1)),
        *((f"{COUPLING} {k}", value) for k, value in enumerate(couplings, 1)),
    ]
