"""How contact is lost in continuous time, and the motion of an axis that touches nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from nrs_design.controllers.controller_design import Controller
from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.contact.kelvin_voigt import KelvinVoigt
from nrs_design.models.linear_form import LinearForm, coordinates
from nrs_design.proof.channels import Output
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.spec import SwitchingSpec
from nrs_design.spec.interaction_parts import FREE
from nrs_design.switched.assumption import say
from nrs_design.switched.modes import Rows, velocity_mode
from nrs_design.switched.shared_state import SharedState

# What is touched where nothing is.
NOTHING = KelvinVoigt(Fraction(0), Fraction(0))


def lost_contact(state: SharedState, contact: str | None) -> Contact | None:
    """Return how contact is lost, or None where that is not modelled.

    Raises
    ------
    AssemblyError
        If it is not modelled, and the spec asks for it.
    """
    if not _can_be_free(state):
        if contact == "losable":
            raise _not_losable("")
        return None
    free = [
        mode for controller in state.design.controllers for mode in free_modes(controller, state)
    ]
    return Contact(
        tuple(free),
        tuple(_pulls(state)),
        required=contact == "losable",
        loss=say("contact-lost.surface"),
    )


def adds_free_motion(state: SharedState, contact: str | None, rules: SwitchingSpec) -> bool:
    """Tell whether free motion is one of the modes: with springs, it ends at rest in one place.

    That contact is lost at any deflection is more than happens, and is covered on demand only.

    Parameters
    ----------
    state : SharedState
        Of all modes.
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
    if not all(controller.law.spring for controller in state.design.controllers):
        raise _not_losable(", where some controllers have a spring Kt, for all that have one")
    if not _can_be_free(state):
        raise _not_losable("")
    if rules.names_contacts or next(rules.dwell_times(), None) is not None:
        raise AssemblyError(
            "where an admittance has a spring Kt, free motion is a mode like others, and contact "
            "is lost whatever the rules of switching say",
            remedy="use `contact: kept`, or rules with transitions between controllers alone",
            at=("switching",),
        )
    return True


def _can_be_free(state: SharedState) -> bool:
    return (
        state.idle is None
        and state.law.commands == "velocity"
        and state.coordinates == "deflection"
        and not any(e.law.remembers or e.law.has_mass or e.preloaded for e in state.environments)
        and not any(e.parts and not e.each_losable for e in state.environments)
        and bool(state.environments)
    )


def _not_losable(which: str) -> AssemblyError:
    return AssemblyError(
        "loss of contact is modelled for impedance controllers on elastic and damped environments "
        f"in deflection coordinates{which}",
        remedy="use `contact: kept`; for position and force controllers on elastic environments, "
        "or prove the sampled loop: add `sampling: {period: 2 ms, delay: 0}`",
        at=("contact",),
    )


def free_modes(controller: Controller, state: SharedState) -> Iterator[Mode]:
    """Yield the modes of a controller that touches nothing, at every corner of its gains."""
    box = state.boxes[controller.name].box.beside(state.motor_box)

    def rows_at(values: Mapping[str, Fraction]) -> Rows:
        law = controller.law.of(values)
        return velocity_mode(state.motion_at(values), law, NOTHING, state.low_pass)

    for corner, rows in box.corners(rows_at, f"{controller.name}/{FREE}"):
        yield Mode(corner, RationalMatrix.from_rows(rows))


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
    size = len(state.names)
    return force_rows(state.motion.output(size), state.names, could_pull(state.environments))


def could_pull(environments: Iterable[Environment]) -> tuple[Environment, ...]:
    """Return whose forces tell where nothing pushes at a positive deflection.

    Without damping nothing lags, and there are none. Beside damped environments springs count, too:
    what flies because every force would pull must not be pushed by a spring instead.

    Parameters
    ----------
    environments : iterable of Environment
        All that may be touched.
    """
    environments = tuple(environments)
    return environments if any("b" in e.parameters for e in environments) else ()


def force_rows(
    velocity: LinearForm, states: Sequence[str], environments: Iterable[Environment]
) -> Iterator[RationalMatrix]:
    """Yield the force, as a row over the states, of each corner of each contact.

    Parameters
    ----------
    velocity : LinearForm
        Of the contact, as a form of the states.
    states : sequence of str
        Names of the states.
    environments : iterable of Environment
        All contacts.
    """
    unit = coordinates(len(states))
    for environment in environments:
        shared, *memories = environment.law.states
        names = [shared, *(f"{environment.name}: {memory}" for memory in memories)]
        own = [unit[states.index(name)] for name in names]
        for law in environment.corners:
            force, _ = law.react(velocity, own)
            yield RationalMatrix.from_rows([force])


def outputs_of(
    velocity: LinearForm,
    states: Sequence[str],
    environments: Iterable[Environment],
    limit: Fraction,
) -> tuple[Output, ...]:
    """Return the force at the corners of its ranges, with what it is meant to keep, and velocity.

    Parameters
    ----------
    velocity, states, environments
        As for `force_rows`.
    limit : Fraction
        Of the force, in N m.
    """
    rows = tuple(force_rows(velocity, states, environments))
    force = (Output("force", "N*m", rows, limit),) if rows else ()
    return (*force, Output("velocity", "rad/s", (RationalMatrix.from_rows([velocity]),)))
