"""Close the loop around every contact: the modes of one robot axis, in one state.

One mode for each controller and each corner of the box of the parameters of each environment that
it may touch. Every entry of A is affine in stiffness and in damping (or in one over it, as the law
of the environment says), and where the motor has ranges in its gain and in one over its time
constant, each for itself, so A is a convex combination of the corners in the whole box, and what
decreases in the corners decreases there, however fast the parameters move.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from itertools import chain, permutations

from nrs_design.controllers.controller_design import Controller
from nrs_design.loop.constraints import assemble_switching, leaving_impedance, zeroing
from nrs_design.loop.free_motion import (
    adds_free_motion,
    flights_among,
    free_modes,
    lost_contact,
    pulls_of,
)
from nrs_design.loop.loop_assumptions import assume_loop
from nrs_design.loop.shared_state import SharedState
from nrs_design.models.contact.environment import Environment
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import SwitchingSpec


def close_loop(
    name: str,
    state: SharedState,
    rules: SwitchingSpec | None = None,
    contact: str | None = None,
) -> SwitchedSystem:
    """Assemble every mode of an interaction design.

    Without rules any controller may follow any other at any time. Contact, losable or kept, may by
    default be lost where that is modelled, and a statement says whether it covers it. An
    `AssemblyError` if it may be lost, and that is not modelled.
    """
    rules, controllers = rules or SwitchingSpec(), state.design.controllers
    sprung = any(controller.law.spring for controller in controllers)
    free = sprung and adds_free_motion(state, contact, rules)
    losable = None if sprung or contact == "kept" else lost_contact(state, contact)
    parts = {c.name: tuple(_all_modes(c, state, free=free)) for c in controllers}
    if rules.names_contacts:
        parts = _by_contact(chain.from_iterable(parts.values()))
    groups = {key: tuple(mode.name for mode in part) for key, part in parts.items()}
    modes = tuple(chain.from_iterable(parts.values()))
    flights = None
    if free:
        names = (mode.name for mode in modes)
        flights = flights_among(names, state.environments, pulls_of(state))
    return SwitchedSystem(
        name=name,
        time=Time.CONTINUOUS,
        states=state.names,
        modes=modes,
        assumptions=assume_loop(state, rules, losable=losable is not None, free=free),
        switching=assemble_switching(rules, groups, _resets(state)),
        contact=losable,
        flights=flights,
        enclosures=tuple(_enclosures(state)),
    )


def _enclosures(state: SharedState) -> Iterator[tuple[str, ...]]:
    """Yield the modes that enclose one motion, where stiffness and damping depend on each other."""
    for controller in state.design.controllers:
        for environment in state.contacts(controller):
            name = f"{controller.name}/{environment.name}"
            box = state.contact_box(environment).beside(state.motor_box)
            found: dict[str, list[str]] = {}
            for point, (corner, _) in zip(
                box.points(name, state.motor_box.ranges), box.named_values(name), strict=True
            ):
                found.setdefault(point, []).append(corner)
            if environment.depends:
                yield from (tuple(names) for names in found.values() if len(names) > 1)


def _resets(state: SharedState) -> Iterator[tuple[str, str, RationalMatrix]]:
    """Yield the switches that set states to zero, and the maps.

    From an impedance controller to others the idle states are, if the spec says so; where force
    control takes the measured position, the lead is.
    """
    controllers = state.design.controllers
    switches: Iterable[tuple[str, str]] = ()
    if state.offset == "measured":
        switches = permutations((c.name for c in controllers), 2)
    elif state.idle is not None and state.idle.reset:
        switches = leaving_impedance(controllers)
    map_ = zeroing(state.names, state.names[state.kept :])
    return ((source, target, map_) for source, target in switches)


def _by_contact(modes: Iterable[Mode]) -> dict[str, tuple[Mode, ...]]:
    """Return the modes by controller and contact, such as ``tissue/soft``, with all corners."""
    found: dict[str, tuple[Mode, ...]] = {}
    for mode in modes:
        name = "/".join(mode.name.split("/")[:2])
        found[name] = (*found.get(name, ()), mode)
    return found


def _all_modes(controller: Controller, state: SharedState, *, free: bool) -> Iterator[Mode]:
    """Yield the modes of a controller in all its contacts, and free ones if they are asked for."""
    touched: list[Environment | None] = [*state.contacts(controller)]
    if not touched:
        # What takes no force is the same everywhere, unless something else feels it.
        touched = [None, *(state.environments if state.feels else ())]
    for environment in touched:
        name = controller.name if environment is None else f"{controller.name}/{environment.name}"
        box = state.contact_box(environment).beside(state.motor_box)
        for corner, rows in box.corners(partial(state.rows, controller.law, environment), name):
            yield Mode(corner, RationalMatrix.from_rows(rows))
    if free:
        yield from free_modes(controller, state)
