"""Contact loss: where contact may be lost, tensile forces, and flights."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from enum import Enum
from fractions import Fraction

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.loop.located import LocatedMode
from nrs_design.models.contact.environment import Environment
from nrs_design.models.linear_form import LinearForm, coordinates
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.channels import Output
from nrs_design.proof.contact import Contact, Flights
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.spec.interaction_parts import FREE


class Loss(Enum):
    """Place of contact loss, by the id of its assumption."""

    NEVER = "contact-kept.never"
    NOT_MODELLED = "contact-kept.not-modelled"
    # Each law states its own assumption.
    LAW_SPECIFIC = "contact-kept.law"
    # At the surface; each statement says whether it covers the loss.
    SURFACE = "contact-lost.surface"
    ANYWHERE = "contact-lost.anywhere"
    UNDER_FORCE_CONTROL = "contact-lost.force-control"

    @property
    def anywhere(self) -> bool:
        """Tell whether contact may be lost at any deflection: free motion is then a mode."""
        return self in (Loss.ANYWHERE, Loss.UNDER_FORCE_CONTROL)

    @classmethod
    def classify(
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
            return cls.UNDER_FORCE_CONTROL if contact == "losable" else cls.LAW_SPECIFIC
        sprung = {c.law.spring != 0 for c in design.controllers}
        if contact == "kept" or ((slowed or True in sprung) and contact is None):
            return cls.NEVER
        if any(
            e.preloaded or e.law.has_memory or (e.parts and not e.each_losable)
            for e in environments
        ):
            return cls.NOT_MODELLED
        return cls.ANYWHERE if sprung == {True} else cls.SURFACE


def lost_on_surface(
    free: Iterable[Mode], tensions: Iterable[RationalMatrix], contact: str | None
) -> Contact:
    """Return that contact is lost where the tissue ends, or would have to pull."""
    losable, loss = contact == "losable", Assumption("contact-lost.surface")
    return Contact(tuple(free), tuple(tensions), required=losable, loss=loss)


def flights_of(
    items: Sequence[LocatedMode],
    environments: Iterable[Environment],
    tensions: tuple[RationalMatrix, ...],
) -> Flights:
    """Return the contact modes, the free modes and the tensile forces."""
    known = {environment.name for environment in environments}
    return Flights(
        tuple(item.name for item in items if item.medium in known),
        tuple(item.name for item in items if item.medium == FREE),
        tensions,
    )


def could_pull(environments: Iterable[Environment]) -> tuple[Environment, ...]:
    """Return the environments whose forces tell a flight at a positive deflection.

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
    """Yield the force, as a row over the states, of each corner of each contact."""
    unit = coordinates(len(states))
    for environment in environments:
        common, *memories = environment.law.states
        signals = [deflection or unit[states.index(common)]]
        signals += [unit[states.index(f"{environment.name}: {memory}")] for memory in memories]
        for law in environment.corners:
            force, _ = law.react(velocity, signals)
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
