"""Graphs as the searches draw them, from the numbers that they find."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.evidence.graph import FormsOnGraph, Multiplier, Node
from nrs_design.proof.lift import monomials
from nrs_design.proof.steps import CONTACT, FREE, ROUNDING, multiplier_names
from nrs_design.proof.system import SwitchedSystem

Integers = Sequence[int]


def undeflected(Q: Matrix, order: int, degree: int = 1) -> Matrix:
    """Return a form where the last state is zero: the block of the monomials without it."""
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
    vanishing: tuple[Matrix, ...] = (),
    lost: bool = False,
) -> FormsOnGraph:
    """Draw one form for all modes, and in free motion the same without the deflection.

    Form and multipliers, in the order of the system, are over ``2^log2``; the rate is alpha in 1/s,
    or rho per step. There is one vanishing matrix for each mode, in contact and free.
    """
    nodes = [Node(CONTACT, Q)]
    if lost:
        nodes.append(Node(FREE, undeflected(Q, system.order, degree)))
    multipliers = _multipliers(system, crossings, roundings)
    found = tuple(Multiplier(fact, value) for fact, value in multipliers)
    return FormsOnGraph(tuple(nodes), log2, rate, degree, found, vanishing)


def _multipliers(
    system: SwitchedSystem, crossings: Integers, roundings: Integers
) -> list[tuple[str, int]]:
    names = multiplier_names(system) if crossings else ()
    return [
        *zip(names, crossings, strict=True),
        *((f"{ROUNDING} {k}", value) for k, value in enumerate(roundings, 1)),
    ]
