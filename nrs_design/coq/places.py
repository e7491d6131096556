"""Rules of switching: one quadratic form for each mode, as a theorem of Coq."""

from __future__ import annotations

from fractions import Fraction
from math import ceil

from nrs_design.coq.flows import FlowStatement
from nrs_design.coq.text import (
    Definitions,
    Theorem,
    factor_of,
    identifiers,
    listed,
    long_integer,
    symmetric,
)
from nrs_design.proof.evidence.graph import FormsOnGraph
from nrs_design.proof.exact import transpose
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.steps import Stays
from nrs_design.proof.system import SwitchedSystem

STAY_LIBRARY = ("forms", "jumps", "stays")
SWITCHES = ("forms", "jumps", "polynomials", "continuous", "bridges", "switches")
# Terms of the series in each piece of a stay, margin for remainder and rounding, and the scale.
TERMS, MARGIN, SCALE = 16, 2**40, 2**60
INTERIOR = "what happens within a stay of a mode that must be left, between its switches"
AVERAGES = "averages of modes, such as values between the corners of ranges"


def places_theorem(system: SwitchedSystem, evidence: FormsOnGraph) -> Theorem:
    """Return the theorem of a certificate with a quadratic form for each mode."""
    flows, definitions = system.time is Time.CONTINUOUS, Definitions()
    names = identifiers(mode.name for mode in system.modes)
    texts = _flowing(system, evidence, definitions) if flows else _stepping(system, evidence)
    for mode in system.modes:
        definitions.define(names[mode.name], texts[mode.name], mode.name)
    places = listed(names[mode.name] for mode in system.modes)
    definitions.define("switches", f"{_switches(system, flows=flows)} : list switch")
    factor = max(factor_of(node.form) for node in evidence.nodes)
    rate, terms = evidence.rate, f"{factor}\n    {places}\n    switches"
    known = f"{rate.numerator} {rate.denominator} {terms}"
    share = f"({rate.numerator} / {rate.denominator})%R"
    sound = "switches" if flows else "stays"
    leaving = (evidence.stays or Stays()).leaving
    return Theorem(
        SWITCHES if flows else STAY_LIBRARY,
        definitions.texts,
        f"{sound}_fall {known}",
        f"decays_by_mode {known}" if flows else f"decays_by_mode {terms}\n    {share}",
        f"{sound}_sound _ _ _ _ _ checked",
        system.states,
        (AVERAGES, INTERIOR) if leaving else (AVERAGES,),
    )


def _stepping(system: SwitchedSystem, evidence: FormsOnGraph) -> dict[str, str]:
    """Return the modes in discrete time."""
    forms, durations = dict(evidence.nodes), system.stays()
    leaving = (evidence.stays or Stays()).leaving
    found = {}
    for mode in system.modes:
        stay = durations[mode.name]
        longest = "None" if stay.longest is None else f"(Some {stay.longest}%nat)"
        left = "true" if mode.name in leaving else "false"
        found[mode.name] = (
            f"Place ({_linear(mode.A)})\n  {symmetric(forms[mode.name])}\n  {stay.shortest}%nat "
            f"{longest} {left}"
        )
    return found


def _flowing(
    system: SwitchedSystem, evidence: FormsOnGraph, definitions: Definitions
) -> dict[str, str]:
    """Return the modes in continuous time, with the inequality of each."""
    forms, stays, flows = dict(evidence.nodes), system.stays(), FlowStatement(system, evidence)
    grams = {place: (gram, factor) for place, gram, factor in flows.witnesses()}
    found = {}
    for k, mode in enumerate(system.modes):
        gram, factor = grams[mode.name]
        dwell = stays[mode.name].shortest
        found[mode.name] = (
            f"Place {len(mode.A.numerators)} ({flows.mode(k, mode, definitions)})\n"
            f"  {symmetric(forms[mode.name])}\n  ({dwell.numerator}, {dwell.denominator})\n"
            f"  (Witness {symmetric(gram, long_integer)} {factor})"
        )
    return found


def _switches(system: SwitchedSystem, *, flows: bool) -> str:
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    stays = system.stays()
    return listed(
        f"Switch {index[edge.source.name]} {index[edge.target.name]} "
        + ("None" if edge.map is None else f"(Some ({_linear(edge.map)}))")
        + (_bridge(edge.source, stays[edge.source.name].shortest) if flows else "")
        for edge in system.edges()
    )


def _bridge(mode: Mode, stay: Fraction) -> str:
    """Return how a stay is followed: in pieces in which the mode does not move far."""
    size = max(sum(map(abs, row)) for row in mode.A.numerators)
    pieces = ceil(2 * stay * Fraction(size, mode.A.denominator)) or 1
    return f" (Bridge {pieces} {TERMS} {MARGIN} {SCALE})"


def _linear(A: RationalMatrix) -> str:
    columns = (listed(map(str, column)) for column in transpose(A.numerators))
    return f"Linear {listed(columns)} {A.denominator}"
