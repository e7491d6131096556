"""Close the loop around every contact: the modes of one robot axis, in one state.

One mode for each controller and each corner of the box of the parameters of each environment that
it may touch. Every entry of A is affine in stiffness and in damping (or in one over it, as the law
of the environment says), and where the motor has ranges in its gain and in one over its time
constant, each for itself, so A is a convex combination of the corners in the whole box, and what
decreases in the corners decreases there, however fast the parameters move.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import permutations, product

from nrs_design.controllers.controller_design import Controller
from nrs_design.loop.constraints import assemble_switching, leaving_impedance, zeroing
from nrs_design.loop.continuous_assumptions import assume_loop
from nrs_design.loop.free_motion import (
    adds_free_motion,
    flights_of,
    free_modes,
    lost_contact,
    pulls_of,
)
from nrs_design.loop.located import (
    ConstantParameter,
    MatrixMode,
    Spot,
    enclosures_of,
    grouped,
    spot_of,
)
from nrs_design.loop.shared_state import SharedState
from nrs_design.models.contact.environment import Environment
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import SwitchingSpec


def close_loop(
    name: str,
    state: SharedState,
    rules: SwitchingSpec | None = None,
    contact: str | None = None,
    constants: Sequence[ConstantParameter] = (),
    *,
    limited: bool = False,
) -> tuple[SwitchedSystem, Sequence[MatrixMode]]:
    """Assemble every mode of an interaction design.

    Without rules any controller may follow any other at any time. Contact, losable or kept, may by
    default be lost where that is modelled, and a statement says whether it covers it. `limited`:
    some statement is about signals that saturate. An `AssemblyError` if contact may be lost, and
    that is not modelled.
    """
    rules, controllers = rules or SwitchingSpec(), state.design.controllers
    sprung = any(controller.law.spring for controller in controllers)
    free = sprung and adds_free_motion(state, contact, rules)
    losable = None if sprung or contact == "kept" else lost_contact(state, contact)
    items: list[MatrixMode] = []
    groups: dict[str, dict[str, None]] = {}
    for c in controllers:
        own = [*_in_contact(c, state, constants, by_contact=rules.names_contacts)]
        own += free_modes(c, state, constants) if free else ()
        groups[c.name] = dict.fromkeys(item.group for item in own)
        items += own
    pulls = tuple(pulls_of(state)) if free else ()
    system = SwitchedSystem(
        name=name,
        time=Time.CONTINUOUS,
        states=state.names,
        modes=tuple(item.mode for item in items),
        assumptions=tuple(
            assume_loop(state, rules, losable=losable is not None, free=free, limited=limited)
        ),
        switching=assemble_switching(rules, grouped(items), _resets(state, groups)),
        contact=losable,
        flights=flights_of(items, state.environments, pulls) if free else None,
        enclosures=tuple(enclosures_of(items)),
    )
    return system, items


def _resets(
    state: SharedState, groups: Mapping[str, Iterable[str]]
) -> Iterator[tuple[str, str, RationalMatrix]]:
    """Yield the switches that set states to zero, and the maps, by the groups of a controller.

    From an impedance controller to others the idle states are, if the spec says so; where force
    control takes the measured position, the lead is.
    """
    controllers = state.design.controllers
    switches: Iterable[tuple[str, str]] = ()
    if state.offset == "measured":
        switches = permutations((c.name for c in controllers), 2)
    elif state.idle is not None and state.idle.reset:
        switches = leaving_impedance(controllers)
    map_ = zeroing(state.names, state.zeroed)
    for source, target in switches:
        yield from ((*pair, map_) for pair in product(groups[source], groups[target]))


def _in_contact(
    controller: Controller,
    state: SharedState,
    constants: Sequence[ConstantParameter],
    *,
    by_contact: bool,
) -> Iterator[MatrixMode]:
    """Yield the modes of a controller in all its contacts, or in none if it takes no force."""
    touched: list[Environment | None] = [*state.contacts(controller)]
    if not touched:
        # A law without force feedback has the same mode in every contact, unless the plant differs.
        touched = [None, *(state.environments if state.feels else ())]
    for e in touched:
        where = () if e is None else (e.name,)
        name = "/".join((controller.name, *where))
        box, known = state.contact_box(e).beside(state.motor_box), (None, *where)
        # Dependent stiffness and damping do not attain every corner.
        real = state.motor_box.ranges if e is not None and e.depends else box.ranges
        own = [constant for constant in constants if constant.contact in known]
        for labels, rows in box.corners(partial(state.rows, controller.law, e), name):
            yield MatrixMode(
                name if by_contact else controller.name,
                Spot.named(controller.name, *where) + spot_of(labels, real, own),
                "" if e is None else e.name,
                RationalMatrix.from_rows(rows),
            )
