"""Close the loop around every contact: the modes of one robot axis, in one state.

One mode for each controller and each corner of the box of its gains and of the parameters of each
environment that it may touch. Every entry of A is affine in stiffness, in damping (or in one over
it, as the law of the environment says) and in the gains (or in one over them, as the law of the
controller says), and where the motor has ranges in its gain and in one over its time constant, each
for itself, so A is a convex combination of the corners in the whole box, and what decreases in the
corners decreases there, however fast the parameters move.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from itertools import chain

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.models.plant import Plant
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import IdleStatesSpec, SwitchingSpec
from nrs_design.spec.controllers import Offset
from nrs_design.switched.constraints import assemble_switching
from nrs_design.switched.free_motion import (
    adds_free_motion,
    among_modes,
    free_modes,
    lost_contact,
)
from nrs_design.switched.gain_box import GainBox
from nrs_design.switched.loop_assumptions import Assumed, assume_loop
from nrs_design.switched.mixture import resets_of
from nrs_design.switched.offset import retaken
from nrs_design.switched.parameters import Corner
from nrs_design.switched.shared_state import SharedState, shared_state


def close_loop(
    name: str,
    plant: Plant,
    loop: MotionLoop,
    design: ControllerDesign,
    coordinates: str,
    rules: SwitchingSpec | None = None,
    boxes: Mapping[str, GainBox] | None = None,
    idle: IdleStatesSpec | None = None,
    contact: str | None = None,
    offset: Offset = "none",
) -> SwitchedSystem:
    """Assemble every mode of an interaction design.

    Parameters
    ----------
    name : str
        Name of the spec.
    plant : Plant
        Environments.
    loop : MotionLoop
        Closed motion loop G.
    design : ControllerDesign
        Gains that ship.
    coordinates : {"deflection", "force"}
        Last state of an impedance mode: the deflection (continuous when the stiffness changes
        in contact, so the physical choice) or the force (the thesis's choice).
    rules : SwitchingSpec, optional
        Rules for the change of controllers; by default any may follow any other at any time.
    boxes : mapping, optional
        Where the gains of controllers may be, by name; by default, at what ships.
    idle : IdleStatesSpec, optional
        What the states of impedance controllers do while another kind of controller is active; by
        default there is one kind only.
    contact : {"losable", "kept"}, optional
        Whether contact may be lost; by default it is where that is modelled, and a statement says
        whether it covers it.
    offset : {"none", "reference", "measured"}
        Where force controllers take their offset from; only where none commands a velocity.

    Raises
    ------
    AssemblyError
        If the modes do not share one state, or the coordinates do not apply.
    """
    rules = rules or SwitchingSpec()
    boxes = {c.name: GainBox.point(c.law) for c in design.controllers} | {**(boxes or {})}
    state = shared_state(plant, loop, design, coordinates, idle, offset)
    sprung = any(controller.law.spring for controller in design.controllers)
    free = sprung and adds_free_motion(state, design, contact, rules)
    losable = None if sprung or contact == "kept" else lost_contact(state, design, boxes, contact)
    parts = {
        controller.name: tuple(_all_modes(controller, plant, state, boxes, free=free))
        for controller in design.controllers
    }
    if rules.names_contacts:
        parts = _by_contact(chain.from_iterable(parts.values()))
    groups = {key: tuple(Corner(mode.name) for mode in part) for key, part in parts.items()}
    modes = tuple(chain.from_iterable(parts.values()))
    assumed = Assumed(
        design,
        state.touched,
        boxes,
        coordinates,
        rules,
        idle,
        state.law,
        given=loop.given,
        losable=losable is not None,
        offset=offset,
        free=free,
        joint=state.joint,
    )
    return SwitchedSystem(
        name,
        Time.CONTINUOUS,
        state.names,
        modes,
        assume_loop(assumed),
        assemble_switching(rules, groups, _resets(state, design)),
        losable,
        flights=among_modes(state, modes) if free else None,
    )


def _resets(
    state: SharedState, design: ControllerDesign
) -> Iterable[tuple[str, str, RationalMatrix]]:
    """Return what switches do to the state."""
    if state.idle is not None and state.idle.reset:
        return resets_of(design, state.realization.order, len(state.beside))
    return retaken(design, state.offset, state.realization.order)


def _by_contact(modes: Iterable[Mode]) -> dict[str, tuple[Mode, ...]]:
    """Return the modes by controller and contact, such as ``tissue/soft``, with all corners."""
    found: dict[str, tuple[Mode, ...]] = {}
    for mode in modes:
        name = "/".join(mode.name.split("/")[:2])
        found[name] = (*found.get(name, ()), mode)
    return found


def _all_modes(
    controller: Controller,
    plant: Plant,
    state: SharedState,
    boxes: Mapping[str, GainBox],
    *,
    free: bool,
) -> Iterator[Mode]:
    """Yield the modes of a controller in all its contacts, and free ones if they are asked for."""
    law, gains = controller.law, boxes[controller.name]
    if not controller.contacts:
        yield Mode(controller.name, RationalMatrix.from_rows(state.placed(law)))
    for environment in map(plant.environment, controller.contacts):
        name = f"{controller.name}/{environment.name}"
        box = state.contact_box(environment).beside(gains.box).beside(state.motor_box)
        for corner, rows in box.corners(partial(state.rows, law, environment), name):
            yield Mode(corner, RationalMatrix.from_rows(rows))
    if free:
        yield from free_modes(controller, state, gains)
