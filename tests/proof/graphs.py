"""Graphs of the usual shapes, drawn from their numbers, and what such a shape is called."""

from collections.abc import Iterable, Sequence
from fractions import Fraction

from nrs_design.proof import steps as facts
from nrs_design.proof.evidence import AbstractEvidence, FormsOnGraph
from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.evidence.graph import MODES, Arc, Multiplier, Node
from nrs_design.proof.lift import monomials
from nrs_design.proof.system import SwitchedSystem

__all__ = [
    "common_polynomial",
    "common_quadratic",
    "conewise_modes",
    "forms_of_steps",
    "in_turns",
    "mode_quadratic",
    "one_form",
    "scalars",
    "shape_of",
]


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
    crossings: Sequence[int] = (),
    roundings: Sequence[int] = (),
    vanishing: tuple[Matrix, ...] = (),
    lost: bool = False,
) -> FormsOnGraph:
    """Draw one form for all modes, and in free motion the same without the deflection.

    Form and multipliers, in the order of the system, are over ``2^log2``; the rate is alpha in 1/s,
    or rho per step. There is one vanishing matrix for each mode, in contact and free.
    """
    nodes = [Node(MODES, Q)]
    if lost:
        nodes.append(Node(facts.FREE, undeflected(Q, system.order, degree)))
    multipliers = _multipliers(system, crossings, roundings)
    found = tuple(Multiplier(fact, value) for fact, value in multipliers)
    return FormsOnGraph(tuple(nodes), log2, rate, degree, found, vanishing)


def _multipliers(
    system: SwitchedSystem, crossings: Sequence[int], roundings: Sequence[int]
) -> list[tuple[str, int]]:
    names = facts.multiplier_names(system) if crossings else ()
    return [
        *zip(names, crossings, strict=True),
        *((f"{facts.ROUNDING} {k}", value) for k, value in enumerate(roundings, 1)),
    ]


def common_quadratic(
    Q: Matrix, log2: int, rate: Fraction, roundings: Sequence[int] = ()
) -> FormsOnGraph:
    found = (Multiplier(f"{facts.ROUNDING} {k}", m) for k, m in enumerate(roundings, 1))
    return FormsOnGraph((Node(MODES, Q),), log2, rate, multipliers=tuple(found))


def common_polynomial(
    degree: int, Q: Matrix, log2: int, vanishing: tuple[Matrix, ...], rate: Fraction
) -> FormsOnGraph:
    return FormsOnGraph((Node(MODES, Q),), log2, rate, degree, vanishing=vanishing)


def in_turns(
    system: SwitchedSystem,
    forms: Sequence[Matrix],
    log2: int,
    rate: Fraction,
    crossings: Sequence[Sequence[int]] = (),
    roundings: Sequence[Sequence[int]] = (),
) -> FormsOnGraph:
    lost, count = system.contact is not None, len(forms)
    nodes, multipliers = [], []
    for k, Q in enumerate(forms):
        nodes.append(Node(f"{MODES} {k}", Q))
        if lost:
            nodes.append(Node(f"{facts.FREE} {k}", undeflected(Q, system.order)))
    width = len(nodes) // count
    for k in range(count):
        first = (k + 1) % count * width
        named = [
            (f"{facts.ROUNDING} {i}", m) for i, m in enumerate(roundings[k] if roundings else (), 1)
        ]
        if crossings and crossings[k]:
            named += zip(facts.multiplier_names(system), crossings[k], strict=True)
        multipliers += [
            Multiplier(fact, value, first + i) for fact, value in named for i in range(width)
        ]
    return FormsOnGraph(tuple(nodes), log2, rate, multipliers=tuple(multipliers))


def mode_quadratic(
    functions: Iterable[tuple[str, Matrix]],
    log2: int,
    rate: Fraction,
    leaving: tuple[str, ...] = (),
    pieces: int = 1,
) -> FormsOnGraph:
    nodes = tuple(Node(name, Q) for name, Q in functions)
    return FormsOnGraph(nodes, log2, rate, stays=facts.Stays(leaving, pieces))


def scalars(*values: int, rate: Fraction | str = Fraction(1, 2), **stays: object) -> FormsOnGraph:
    named = tuple((f"m{i}", ((value,),)) for i, value in enumerate(values))
    return mode_quadratic(named, 0, Fraction(rate), **stays)


def conewise_modes(
    touching: Sequence[tuple[str, Matrix]],
    flying: Sequence[tuple[str, Matrix]],
    log2: int,
    rate: Fraction,
    multipliers: Sequence[int],
) -> FormsOnGraph:
    """The function of a state is that of the mode that takes the next step."""
    nodes = [Node(MODES, Q) for _, Q in touching] + [Node(facts.FREE, R) for _, R in flying]
    edges = (Arc(k, name, None) for k, (name, _) in enumerate((*touching, *flying)))
    lost = (Multiplier(facts.LOST, m, k) for k, m in enumerate(multipliers, len(touching)))
    return FormsOnGraph(tuple(nodes), log2, rate, multipliers=tuple(lost), edges=tuple(edges))


def shape_of(evidence: AbstractEvidence | None) -> str | None:
    if not isinstance(evidence, FormsOnGraph):
        return None if evidence is None else evidence.kind
    degree = "quadratic" if evidence.degree == 1 else "polynomial"
    if any(edge.target is not None for edge in evidence.edges):
        return f"memory-{degree}"
    if evidence.stays is not None:
        return f"mode-{degree}"
    if any(node.place[-1].isdecimal() for node in evidence.nodes):
        return f"periodic-{degree}"
    if len(evidence.edges) > 1:
        return f"conewise-mode-{degree}"
    return f"conewise-{degree}" if evidence.covers_lost_contact else f"common-{degree}"


def forms_of_steps(
    system: SwitchedSystem,
    acting: facts.Acting,
    function: tuple[Matrix, int],
    keeps: Fraction,
    crossings: Sequence[int] = (),
    roundings: Sequence[int] = (),
):
    """Return what one function must fulfil in steps, with where it is."""
    Q, log2 = function
    names = facts.multiplier_names(system) if crossings else ()
    steps = facts.steps_of(system, acting, facts.grain_of(keeps), lost=True)
    return facts.forms_of_one(steps, Q, keeps, facts.by_fact(names, crossings, roundings), log2)
