"""Page of a statement, and the content that each kind of evidence offers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.evidence.graph import MODES
from nrs_design.proof.steps import FREE
from nrs_design.reporting.document import Section


@dataclass(frozen=True)
class Page:
    """Name, meaning, limits, tables and simulated run of one statement.

    The claim is that of the evidence, and no page repeats it.
    """

    name: str  # Name of the kind in a few words, for a table
    meaning: tuple[str, ...]  # Meaning of the claim, its assumptions and its decision
    limits: tuple[str, ...]  # Limits of the claim
    # Run below the proved bound, or a witness of instability; None without a decision.
    run: Callable[[], Section] | None = None
    sections: Callable[[], tuple[Section, ...]] = tuple  # The numbers in tables
    changing: str = "however fast they change"  # Which values between corners are covered


@dataclass(frozen=True)
class Form:
    """A positive definite form ``z' Q z``, with z all monomials of one degree in the states."""

    Q: Matrix  # numerators
    name: str = ""  # of the mode, step or end where it holds; empty: everywhere
    degree: int = 1  # of the monomials; 1 for a quadratic function
    free: bool = False  # in free motion, without the last state (the deflection)
    corner: int | None = None  # of constant parameters


@dataclass(frozen=True)
class Offer:
    """Content of evidence for a page, of any kind."""

    forms: tuple[Form, ...] = ()
    denominator_log2: int = 0  # of all forms
    leaving: tuple[str, ...] = ()  # modes that must be left, in which a form may grow
    weights: tuple[tuple[str, Fraction], ...] = ()  # of modes, with sum one
    # Closed sequence along which some state does not decay:
    steps: tuple[tuple[str, Fraction], ...] = ()  # mode, and time in it in s (or steps)
    edges: tuple[int, ...] = ()  # which reset each switch takes; empty: no choice
    factor: Fraction | None = None  # lower bound of the growth per sequence, signs of contact kept
    shares: tuple[Fraction, ...] = ()  # value of constant parameters, 0 low end, 1 high end
    blocks: tuple[tuple[int, ...], ...] = ()  # states of each diagonal block
    parts: tuple[tuple[int, AbstractEvidence], ...] = ()  # evidence of a block, or of a value


def offer_of(evidence: AbstractEvidence) -> Offer:
    """Return the content of evidence; an empty offer for an unknown kind."""
    read = OFFERS.get(evidence.kind)
    return Offer() if read is None else read(evidence)


def _quadratic_offer(e: Any) -> Offer:
    return Offer((Form(e.Q),), e.denominator_log2)


def _graph(e: Any) -> Offer:
    """Return the quadratic forms of a Lyapunov graph, with their names and free motion."""
    if e.stays is not None:
        forms = tuple(Form(Q, place, e.degree) for place, Q in e.nodes)
        return Offer(forms, e.denominator_log2, leaving=e.stays.leaving)
    # A path-dependent form belongs to a mode sequence, not to the mode of its outgoing edge.
    names = {edge.source: edge.mode or "" for edge in e.edges if edge.target is None}
    touching, flying = list[Form](), list[Form]()
    for k, (place, Q) in enumerate(e.nodes):
        turn = place.removeprefix(f"{MODES} ")
        name = names.get(k) or (f"step {int(turn) + 1}" if turn.isdecimal() else "")
        free = place.startswith(FREE)
        (flying if free else touching).append(Form(Q, name, e.degree, free))
    several = any(edge.source is not None for edge in e.edges)
    return Offer((*touching, *(flying if several else ())), e.denominator_log2)


def _corners(e: Any) -> Offer:
    forms = (Form(P, f"corner {k + 1}", corner=k) for k, P in enumerate(e.functions))
    return Offer(tuple(forms), e.denominator_log2)


def _traces(e: Any) -> Offer:
    """Return the share of each mode in the trace of X, the heaviest first."""
    traces = {name: sum(v * v for row in L for v in row) for name, L in e.factors}
    total = sum(traces.values())
    heaviest = sorted(traces, key=lambda name: -traces[name])
    return Offer(weights=tuple((name, Fraction(traces[name], total)) for name in heaviest))


def _sequence(e: Any) -> Offer:
    if e.shares:
        return Offer(shares=e.shares, parts=((0, replace(e, shares=())),))
    if e.names_unstable_mode:
        return Offer(steps=((e.steps[0][0], Fraction(0)),))
    if e.is_average:
        return Offer(weights=e.steps)
    return Offer(steps=e.steps, edges=e.edges, factor=None if e.factor is None else e.factor[0])


# By kind of evidence: the only place in the reports that knows a kind by its name.
OFFERS: Mapping[str, Callable[[Any], Offer]] = {
    "block-triangular": lambda e: Offer(blocks=e.blocks, parts=e.parts),
    "constants-quadratic": _corners,
    "graph": _graph,
    "growing-sequence": _sequence,
    "invariant-ellipsoid": _quadratic_offer,
    "no-common-quadratic": _traces,
    # The form acts on (1, state) and is indefinite: nothing to draw.
    "offset-ellipsoid": lambda e: Offer(),
    "saturated-ellipsoid": _quadratic_offer,
}
