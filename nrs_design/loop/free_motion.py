"""Contact loss, and the modes of free motion in continuous time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from enum import Enum
from fractions import Fraction

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.errors import AssemblyError
from nrs_design.loop.located import (
    ConstantParameter,
    LocatedMode,
    Period,
    Spot,
    spot_of,
)
from nrs_design.loop.modes import Rows, velocity_mode
from nrs_design.loop.shared_state import SharedState
from nrs_design.models.contact.environment import Environment
from nrs_design.models.contact.kelvin_voigt import KelvinVoigt
from nrs_design.models.linear_form import LinearForm, coordinates
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.channels import Output
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.spec import SwitchingSpec
from nrs_design.spec.interaction_parts import FREE


class Loss(Enum):
    """Place of contact loss, by the id of its assumption."""

    NEVER = "contact-kept.never"
    NOT_MODELLED = "contact-kept.not-modelled"
    # Each law states its own assumption.
    BY_LAWS = "contact-kept.law"
    # At the surface; each statement says whether it covers the loss.
    SURFACE = "contact-lost.surface"
    ANYWHERE = "contact-lost.anywhere"
    UNDER_FORCE_CONTROL = "contact-lost.force-control"

    @property
    def anywhere(self) -> bool:
        """Whether contact is lost at any deflection, so that free motion is one of the modes."""
        return self in (Loss.ANYWHERE, Loss.UNDER_FORCE_CONTROL)

    @classmethod
    def of(
        cls,
        contact: str | None,
        environments: Iterable[Environment],
        design: ControllerDesign,
        *,
        slowed: bool,
    ) -> Loss:
        """Tell how contact is lost, by the key `contact` of a spec.

        With springs everywhere free motion is a mode like others. A motor that is `slowed` by what
        it touches would lose it within a period, too, which has to be asked for.
        """
        if any(c.law.commands == "position" for c in design.controllers):
            # Force control has the same equilibrium in free motion: the commanded position.
            return cls.UNDER_FORCE_CONTROL if contact == "losable" else cls.BY_LAWS
        sprung = {c.law.spring != 0 for c in design.controllers}
        if contact == "kept" or ((slowed or True in sprung) and contact is None):
            return cls.NEVER
        if any(
            e.preloaded or e.law.remembers or (e.parts and not e.each_losable) for e in environments
        ):
            return cls.NOT_MODELLED
        return cls.ANYWHERE if sprung == {True} else cls.SURFACE


# An environment without force.
NOTHING = KelvinVoigt(Fraction(0), Fraction(0))


def lost_contact(state: SharedState, contact: str | None) -> Contact | None:
    """Return the model of contact loss, or None without one.

    An `AssemblyError` if the spec asks for it then.
    """
    if not _can_be_free(state):
        if contact == "losable":
            raise _not_losable("")
        return None
    free = (item.mode for c in state.design.controllers for item in free_modes(c, state))
    return lost_on_surface(free, pulls_of(state), contact)


def lost_on_surface(
    free: Iterable[Mode], pulls: Iterable[RationalMatrix], contact: str | None
) -> Contact:
    """Return that contact is lost where the tissue ends, or would have to pull."""
    losable, loss = contact == "losable", Assumption("contact-lost.surface")
    return Contact(tuple(free), tuple(pulls), required=losable, loss=loss)


def adds_free_motion(state: SharedState, contact: str | None, rules: SwitchingSpec) -> bool:
    """Tell whether free motion is one of the modes: with springs, it ends at rest in one place.

    That contact is lost at any deflection is more than happens, and is covered on demand only. An
    `AssemblyError` if the spec asks for it, and it is not modelled or the rules exclude it.
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
        and not any(e.law.remembers or e.law.has_mass or e.preloaded for e in state.environments)
        and not any(e.parts and not e.each_losable for e in state.environments)
        and bool(state.environments)
    )


def _not_losable(which: str) -> AssemblyError:
    return AssemblyError(
        "loss of contact is modelled for impedance controllers on elastic and damped environments"
        f"{which}",
        remedy="use `contact: kept`",
        at=("contact",),
    )


def free_modes(
    controller: Controller, state: SharedState, constants: Sequence[ConstantParameter] = ()
) -> Iterator[LocatedMode]:
    """Yield the modes of a controller that touches nothing, at every corner of the motor."""

    def rows_at(values: Mapping[str, Fraction]) -> Rows:
        return velocity_mode(state.motion_at(values), controller.law, NOTHING, state.low_pass)

    head = Spot.named(controller.name, FREE)
    everywhere = [constant for constant in constants if constant.contact is None]
    for labels, rows in state.motor_box.corners(rows_at, f"{controller.name}/{FREE}"):
        spot = head + spot_of(labels, state.motor_box.ranges, everywhere)
        yield LocatedMode(controller.name, spot, FREE, Period(rows))


def flights_of(
    items: Sequence[LocatedMode],
    environments: Iterable[Environment],
    pulls: tuple[RationalMatrix, ...],
) -> Flights:
    """Return the contact modes, the free modes and the tensile forces."""
    known = {environment.name for environment in environments}
    return Flights(
        tuple(item.name for item in items if item.touches in known),
        tuple(item.name for item in items if item.touches == FREE),
        pulls,
    )


def pulls_of(state: SharedState) -> Iterator[RationalMatrix]:
    """Yield the forces of what could pull, at the corners of their ranges."""
    velocity = state.motion.output(len(state.names))
    return force_rows(velocity, state.names, could_pull(state.environments))


def could_pull(environments: Iterable[Environment]) -> tuple[Environment, ...]:
    """Return whose forces tell where nothing pushes at a positive deflection.

    Without damping nothing lags, and there are none. Beside damped environments springs count, too:
    what flies because every force would pull must not be pushed by a spring instead.
    """
    environments = tuple(environments)
    springs = all(law.is_spring for e in environments for law in e.corners)
    return () if springs else environments


def force_rows(
    velocity: LinearForm,
    states: Sequence[str],
    environments: Iterable[Environment],
    deflection: LinearForm | None = None,
) -> Iterator[RationalMatrix]:
    """Yield the force, as a row over the states, of each corner of each contact.

    The deflection is a state, unless it is given.
    """
    unit = coordinates(len(states))
    for environment in environments:
        shared, *memories = environment.law.states
        own = [deflection or unit[states.index(shared)]]
        own += [unit[states.index(f"{environment.name}: {memory}")] for memory in memories]
        for law in environment.corners:
            force, _ = law.react(velocity, own)
            yield RationalMatrix.from_rows([force])


def outputs_of(
    velocity: LinearForm,
    states: Sequence[str],
    environments: Iterable[Environment],
    limit: Fraction,
) -> tuple[Output, ...]:
    """Return the force at the corners of its ranges, with its limit in N m, and the velocity."""
    rows = tuple(force_rows(velocity, states, environments))
    force = (Output("force", "N*m", rows, limit),) if rows else ()
    return (*force, Output("velocity", "rad/s", (RationalMatrix.from_rows([velocity]),)))
