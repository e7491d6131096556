"""Which graph is drawn for which system, and how its program is asked for rates (untrusted)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.clock import on_turn
from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import Arc, Multiplier, Node
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.steps import CONTACT, FREE, ROUNDING
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.balance import own_norm, scale_states
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.conewise_program import Motions, separating_coordinates
from nrs_design.search.conewise_quadratic import WITH_ERRORS
from nrs_design.search.decay import RESOLUTION, SMALLEST, fastest_first, limit_rate
from nrs_design.search.family import Family, stand_ins, to_floats
from nrs_design.search.forms import Coordinates, Drawing, Program
from nrs_design.search.rounding import BACK_OFFS, claims, digits, rate_at
from nrs_design.work import Cost, NotAffordableError

Array = NDArray[np.float64]

# Work for each edge, to have it in floating point.
PER_EDGE = 5e-5
# Programs take the steps of a system in units that suit this rate.
ANY_RATE = Fraction(1)
# The mean of all modes of a round may grow: what is kept of it then is this.
KEPT = 0.99
# Where more conditions than this are to be checked, what the arithmetic rounds is left out.
MOST_ROUNDED = 250


@dataclass(frozen=True)
class Rates:
    """How rates are looked for: a program that takes long is asked rarely."""

    share: float = 1.0  # Of the budget, for the largest rate
    resolution: float = RESOLUTION
    smallest: float = SMALLEST
    nearest: float = BACK_OFFS[0]
    few: bool = False
    bits: Sequence[int] = field(default_factory=digits)


def propose(
    program: Program, family: Family, limit: float, rates: Rates, errors: Sequence[bool] = (False,)
) -> Candidates[FormsOnGraph]:
    """Solve for any rate; then, if asked to, for the largest, which is proposed first.

    Parameters
    ----------
    program : Program
        Of a graph.
    family : Family
        Of its system.
    limit : float
        The rate that no form can beat.
    rates : Rates
        How the largest rate is looked for.
    errors : sequence of bool
        Whether to cover what the arithmetic rounds: all ways in order.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    time, allowance = family.system.time, family.allowance
    first = program.solve(rate_at(0.0, limit, time), allowance)
    if first is None:
        return NO_MARGIN
    for covered in errors:
        bits = WITH_ERRORS if covered else rates.bits
        if family.optimize_rate:
            try:
                for solution, claim in fastest_first(
                    program.solve,
                    limit,
                    time,
                    allowance.part(rates.share),
                    resolution=rates.resolution,
                    smallest=rates.smallest,
                    nearest=rates.nearest,
                    few=rates.few,
                ):
                    for evidence in program.roundings(solution, claim, bits, errors=covered):
                        yield Candidate(evidence, "found with the largest decay rate")
            except NotAffordableError:
                pass
        for claim in claims(1.0, program.own_rate(first), time):
            for evidence in program.roundings(first, claim, bits, errors=covered):
                yield Candidate(evidence)
    return None


def search_conewise_modes(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a form for each mode, in contact and in free motion.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    # What is left of the budget is for simpler functions in kept contact.
    allowance = family.allowance.part(0.25)
    nodes = len(family.system.modes) + len(_free(family.system))
    allowance.require(Cost(PER_EDGE * 2 * nodes**2), f"a graph of {2 * nodes**2} edges")
    drawing = draw_conewise_modes(family)
    if not drawing.is_finite:
        return OUT_OF_RANGE
    own = replace(family, allowance=allowance)
    return (yield from propose(Program(drawing), own, family.limit, Rates(bits=digits(12))))


def draw_conewise_modes(family: Family) -> Drawing:
    """Draw a node for each mode, in contact and free, which takes its steps to every node."""
    system, motions = family.system, Motions.of(family)
    own = Coordinates(family.exponents, separating_coordinates(motions))
    flying = Coordinates(family.exponents[:-1], own.T[:-1, :-1])
    free = _free(system)
    names = [mode.name for mode in (*system.modes, *free)]
    like = stand_ins(names[: len(system.modes)], motions.contact)
    like |= stand_ins(names[len(system.modes) :], motions.free)
    number = {name: k for k, name in enumerate(dict.fromkeys(like.values()))}
    contact = {like[mode.name] for mode in system.modes}
    return Drawing(
        system,
        FormsOnGraph(
            tuple(Node(CONTACT if k < len(system.modes) else FREE, ()) for k in range(len(names))),
            0,
            ANY_RATE,
            # The form of a state is that of the mode that takes the next step.
            edges=tuple(Arc(k, name, None) for k, name in enumerate(names)),
        ),
        tuple(number[like[name]] for name in names),
        tuple(own if name in contact else flying for name in number),
    )


def search_periodic_quadratic(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a form for each step of a round, where modes take turns.

    Where the arithmetic rounds, forms that cover that are tried before others, unless there are
    too many conditions to check.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    system, clock = family.system, family.system.clock
    if clock is None:
        return NO_MARGIN
    if not np.isfinite(family.matrices).all():
        return OUT_OF_RANGE
    drawing = draw_turns(family, clock)
    if not drawing.is_finite:
        return OUT_OF_RANGE
    checked = (len(system.modes) + len(_free(system))) * clock.length
    ways = (True, False) if system.roundings and checked <= MOST_ROUNDED else (False,)
    # At the largest rate itself there is no room for rounding.
    rates = Rates(0.5, resolution=2.0**-5, nearest=0.99, few=True, bits=digits(24))
    return (yield from propose(Program(drawing), family, _limit(family, clock), rates, ways))


def draw_turns(family: Family, clock: Clock) -> Drawing:
    """Draw a node for each step of a round; in free motion it has the same form."""
    system, lost = family.system, family.system.contact is not None
    places = [CONTACT, FREE] if lost else [CONTACT]
    nodes = tuple(Node(f"{place} {k}", ()) for k in range(clock.length) for place in places)
    roundings = range(1, len(system.roundings) + 1)
    graph = FormsOnGraph(
        nodes,
        0,
        ANY_RATE,
        multipliers=tuple(Multiplier(f"{ROUNDING} {k}", None, 0) for k in roundings),
    )
    forms = tuple(k for k in range(clock.length) for _ in places)
    coordinates = (Coordinates(family.exponents, T) for T in _coordinates(family, clock))
    return Drawing(system, graph, forms, tuple(coordinates))


def _turns(family: Family, clock: Clock) -> list[Array]:
    """Return the modes of the first step of a round, and those of the others."""
    parts = (on_turn(family.system, clock, step) for step in range(2))
    return [
        scale_states(to_floats([mode.A for mode in part.modes]), family.exponents) for part in parts
    ]


def _coordinates(family: Family, clock: Clock) -> Iterator[Array]:
    """Yield the T of every step, which leave the deflection alone.

    What a mean mode keeps of the state until it is at rest is round in them.
    """
    means = [matrices.mean(axis=0) for matrices in _turns(family, clock)]
    each = [means[min(step, 1)] for step in range(clock.length)]
    n = family.system.order
    whole = np.eye(n)
    for mean in each:
        whole = mean @ whole
    radius = float(np.abs(np.linalg.eigvals(whole)).max())
    share = min(1.0, (KEPT / radius) ** (1 / len(each))) if radius > 0 else 1.0
    # In coordinates of like size, all is counted at every step.
    form, forms = own_norm(share ** len(each) * whole, Time.DISCRETE), list[Array]()
    for mean in reversed(each * 2):
        form = np.eye(n) / len(each) + share**2 * mean.T @ form @ mean
        forms.append(form)
    for P in forms[: -len(each) - 1 : -1]:
        if family.system.contact is None:
            yield np.asarray(np.linalg.inv(np.linalg.cholesky(P)).T)
            continue
        T = np.zeros_like(P)
        T[:-1, :-1] = np.linalg.inv(np.linalg.cholesky(P[:-1, :-1])).T
        T[-1, -1] = 1 / np.sqrt(P[-1, -1])
        yield T


def _limit(family: Family, clock: Clock) -> float:
    """Return the contraction per step of the slowest round of like modes."""
    first, others = _turns(family, clock)
    rounds = [np.linalg.matrix_power(B, clock.length - 1) @ A for A in first for B in others]
    slowest = max(limit_rate(whole[None], Time.DISCRETE) for whole in rounds)
    return float(slowest ** (1 / clock.length))


def _free(system: SwitchedSystem) -> tuple[Mode, ...]:
    return (system.contact or Contact(())).free
