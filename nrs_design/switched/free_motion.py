"""How contact is lost in continuous time, and the motion of an axis that touches nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from functools import partial

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.laws import CompliantLaw
from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.contact.kelvin_voigt import KelvinVoigt
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.models.linear_form import coordinates
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.spec import SwitchingSpec
from nrs_design.spec.interaction_parts import FREE
from nrs_design.switched.assumptions import LOST_CONTACT
from nrs_design.switched.gain_box import GainBox
from nrs_design.switched.modes import Rows, velocity_mode
from nrs_design.switched.shared_state import SharedState

# What is touched where nothing is.
NOTHING = KelvinVoigt(Fraction(0), Fraction(0))


def lost_contact(
    state: SharedState,
    design: ControllerDesign,
    boxes: Mapping[str, GainBox],
    contact: str | None,
) -> Contact | None:
    """Return how contact is lost, or None where that is not modelled.

    Parameters
    ----------
    state : SharedState
        Of all modes.
    design : ControllerDesign
        Gains that ship.
    boxes : mapping
        Where the gains of controllers may be, by name.
    contact : {"losable", "kept"} or None
        What the spec asks for.

    Raises
    ------
    AssemblyError
        If it is not modelled, and the spec asks for it.
    """
    if not _can_be_free(state):
        if contact == "losable":
            raise _not_losable("")
        return None
    free = [mode for c in design.controllers for mode in free_modes(c, state, boxes[c.name])]
    return Contact(
        tuple(free), tuple(_pulls(state)), required=contact == "losable", loss=LOST_CONTACT
    )


def adds_free_motion(
    state: SharedState, design: ControllerDesign, contact: str | None, rules: SwitchingSpec
) -> bool:
    """Tell whether free motion is one of the modes: with springs, it ends at rest in one place.

    That contact is lost at any deflection is more than happens, and is covered on demand only.

    Parameters
    ----------
    state : SharedState
        Of all modes.
    design : ControllerDesign
        Gains that ship.
    contact : {"losable", "kept"} or None
        What the spec asks for.
    rules : SwitchingSpec
        Rules for the change of controllers.

    Raises
    ------
    AssemblyError
        If it is not modelled, or excluded by the rules of switching, and the spec asks for it.
    """
    if contact != "losable":
        return False
    if not all(controller.law.spring for controller in design.controllers):
        raise _not_losable(", where some controllers have a spring Kt, for all that have one")
    if not _can_be_free(state):
        raise _not_losable("")
    _check_rules_of_flight(rules)
    return True


def _can_be_free(state: SharedState) -> bool:
    return (
        state.idle is None
        and state.law.commands == "velocity"
        and state.coordinates == "deflection"
        and not any(e.law.remembers or e.law.has_mass or e.preloaded for e in state.touched)
        and not any(e.parts and not e.each_losable for e in state.touched)
        and bool(state.touched)
    )


def _not_losable(which: str) -> AssemblyError:
    return AssemblyError(
        "loss of contact is modelled for impedance controllers on elastic and damped environments "
        f"in deflection coordinates{which}",
        remedy="use `contact: kept`; for position and force controllers on elastic environments, "
        "or prove the sampled loop: add `sampling: {period: 2 ms, delay: 0}`",
        at=("contact",),
    )


def free_modes(controller: Controller, state: SharedState, gains: GainBox) -> Iterator[Mode]:
    """Yield the modes of a controller that touches nothing, at every corner of its gains.

    Parameters
    ----------
    controller : Controller
        With its law.
    state : SharedState
        Of all modes.
    gains : GainBox
        Where its gains may be.
    """
    box, rows_at = gains.box.beside(state.motor_box), partial(_free_rows, state, controller.law)
    for corner, rows in box.corners(rows_at, f"{controller.name}/{FREE}"):
        yield Mode(corner, RationalMatrix.from_rows(rows))


def _free_rows(state: SharedState, law: CompliantLaw, values: Mapping[str, Fraction]) -> Rows:
    return velocity_mode(state.motion_at(values), law.of(values), NOTHING, state.low_pass)


def among_modes(state: SharedState, modes: Iterable[Mode]) -> Flights:
    """Tell which modes are free motion, where it is among them.

    Parameters
    ----------
    state : SharedState
        Of all modes.
    modes : iterable of Mode
        All of them; a controller without contacts has neither a mode in contact nor a free one.
    """
    named = [mode.name.split("/") for mode in modes]
    touching = tuple("/".join(name) for name in named if len(name) > 1 and name[1] != FREE)
    flying = tuple("/".join(name) for name in named if len(name) > 1 and name[1] == FREE)
    return Flights(touching, flying, tuple(_pulls(state)))


def _pulls(state: SharedState) -> Iterator[RationalMatrix]:
    """Yield the forces of what could pull, at the corners of their ranges."""
    acting = could_pull(state.touched)
    return (_force_row(state, law) for environment in acting for law in environment.corners)


def could_pull(touched: Iterable[Environment]) -> tuple[Environment, ...]:
    """Return whose forces tell where nothing pushes at a positive deflection.

    Without damping nothing lags, and there are none. Beside damped environments springs count, too:
    what flies because every force would pull must not be pushed by a spring instead.

    Parameters
    ----------
    touched : iterable of Environment
        All that may be touched.
    """
    touched = tuple(touched)
    return touched if any("b" in e.parameters for e in touched) else ()


def _force_row(state: SharedState, law: AbstractLinearLaw) -> RationalMatrix:
    """Return the force of a damped spring as a row on the states."""
    own = coordinates(len(state.names))
    force, _ = law.react(state.motion.output(len(own)), own[-1:])
    return RationalMatrix.from_rows([force])


def _check_rules_of_flight(rules: SwitchingSpec) -> None:
    """Refuse rules that would forbid free motion to come and go while a controller is active."""
    if rules.names_contacts or next(rules.dwell_times(), None) is not None:
        raise AssemblyError(
            "where an admittance has a spring Kt, free motion is a mode like others, and contact "
            "is lost whatever the rules of switching say",
            remedy="use `contact: kept`, or rules with transitions between controllers alone",
            at=("switching",),
        )
