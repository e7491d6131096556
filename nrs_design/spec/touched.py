"""What controllers touch: names that are there, and laws of contact that are modelled for them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Literal

from nrs_design.spec.controllers import ControllerSpec, contact_name, names_in, touched_in
from nrs_design.spec.environment import EnvironmentSpec
from nrs_design.spec.faults import all_of, did_you_mean, fault

if TYPE_CHECKING:
    from nrs_design.spec.interaction_parts import AbstractInteractionSpec

# The contact in the names of the modes of free motion.
FREE = "free"
# What the motion controller is called where gains are listed.
MOTION = "motion"


def check_free(environments: Mapping[str, EnvironmentSpec]) -> None:
    """Refuse the name that the modes of free motion have."""
    if FREE in environments:
        raise fault(
            f"an environment cannot be called {FREE!r}: so are the modes without contact",
            "call it by what it is, such as `tissue`",
            "environments",
            FREE,
        )


def check_controller_names(controllers: Mapping[str, ControllerSpec]) -> None:
    """Refuse the name that the motion controller has."""
    if MOTION in controllers:
        raise fault(
            f"a controller cannot be called {MOTION!r}: so is the motion loop among the gains and "
            "the modes",
            "call it by what it does, such as `insertion`",
            "controllers",
            MOTION,
        )


def check_references(
    name: str,
    controller: ControllerSpec,
    environments: dict[str, EnvironmentSpec],
) -> None:
    """Refuse names of environments that are not there, and a design for what is not touched.

    Parameters
    ----------
    name : str
        Of the controller.
    controller : ControllerSpec
        What the spec says of it.
    environments : dict
        What there is to touch, by name.
    """
    if controller.environment is None:
        return

    def check(environment: str, *at: int | str) -> None:
        if environment not in environments:
            raise fault(
                f"there is no environment {environment!r}",
                did_you_mean(environment, environments),
                "controllers",
                name,
                *at,
            )

    all_of(
        partial(check, controller.environment, "environment"),
        # By default the contact is the environment itself.
        *(
            partial(check, name, "contacts", index)
            for index, contact in enumerate(controller.contacts)
            for name in names_in(contact)
            if "contacts" in controller.model_fields_set
        ),
    )
    if controller.environment not in touched_in(controller.contacts):
        raise fault(
            f"{name!r} is designed for {controller.environment!r}, but that is not among its "
            "contacts: nothing would be proved about it there",
            f"add {controller.environment} to contacts, or design it for one of them",
            "controllers",
            name,
            "contacts",
        )


def check_springs(
    name: str, controller: ControllerSpec, environments: dict[str, EnvironmentSpec]
) -> None:
    """Refuse force control of what is no spring: its force is not that of the position alone.

    Parameters
    ----------
    name : str
        Of the controller.
    controller : ControllerSpec
        What the spec says of it.
    environments : dict
        What there is to touch, by name.
    """
    if controller.commands == "velocity":
        return
    for contact in touched_in(controller.contacts):
        environment = environments.get(contact)
        if environment is None or environment.is_spring:
            continue
        what = "remembers" if environment.remembers else "has damping"
        raise fault(
            f"force control in contact with {contact!r} is not modelled: it is "
            f"{environment.model}, and {what}",
            "use an elastic environment for force controllers",
            "controllers",
            name,
            "contacts" if "contacts" in controller.model_fields_set else "environment",
        )


def check_memories(
    controllers: dict[str, ControllerSpec],
    environments: dict[str, EnvironmentSpec],
    coordinates: str,
) -> None:
    """Refuse what is not modelled about environments that remember.

    Parameters
    ----------
    controllers, environments : dict
        By name.
    coordinates : {"deflection", "force"}
        State of the contact.
    """
    touched = {
        contact: environments[contact]
        for controller in controllers.values()
        for contact in touched_in(controller.contacts)
        if contact in environments
    }
    for name, environment in touched.items():
        if not environment.has_rest and len(touched) > 1:
            others = ", ".join(other for other in touched if other != name)
            raise fault(
                f"{environment.model} has no rest position, so {name!r} shares no deflection with "
                f"{others}",
                "let the controllers touch no other environment, or write a spec for each",
                "environments",
                name,
                "model",
            )
        if environment.remembers and coordinates == "force":
            raise fault(
                f"force coordinates do not apply to {name!r}, which is {environment.model}",
                "use `coordinates: deflection`",
                "coordinates",
            )


def check_at_once(
    name: str,
    controller: ControllerSpec,
    environments: dict[str, EnvironmentSpec],
    losable: Literal["losable", "kept"] | None,
) -> None:
    """Refuse what is not modelled about several things that are touched at once.

    Parameters
    ----------
    name : str
        Of the controller.
    controller : ControllerSpec
        What the spec says of it.
    environments : dict
        What there is to touch, by name.
    losable : {"losable", "kept"}, optional
        Whether contact may be lost, if the spec says so.
    """
    for index, contact in enumerate(controller.contacts):
        known = [(key, environments[key]) for key in names_in(contact) if key in environments]
        if len(names_in(contact)) == 1:
            continue
        at = ("controllers", name, "contacts", index)
        for key, environment in known:
            if environment.remembers or environment.has_mass:
                what = "has a mass" if environment.has_mass else "remembers"
                raise fault(
                    f"{key!r}, which is {environment.model}, {what}: touching it at once with "
                    "others is not modelled",
                    "use elastic or kelvin-voigt environments there",
                    *at,
                )
            if losable == "losable" and not environment.is_losable:
                raise fault(
                    f"losing {key!r} on its own is not modelled while {contact_name(contact)} are "
                    "touched at once: it has damping or a preload",
                    "use `contact: kept`, or elastic environments",
                    *at,
                )


def check_hands(spec: AbstractInteractionSpec) -> None:
    """Refuse what is not modelled about a hand, whose mass moves with the contact."""
    touched = sorted(spec.touched & spec.environments.keys())
    hands = [name for name in touched if spec.environments[name].has_mass]
    if not hands:
        return
    beside: tuple[tuple[bool, str, str], ...] = (
        (spec.contact == "losable", "contact", "loss of contact"),
        (spec.sampling is not None, "sampling", "a sampled loop"),
        (spec.disturbances is not None, "disturbances", "a bound under disturbances"),
        (spec.coupling is not None, "coupling", "axes that act on each other"),
        (spec.idle_states is not None, "idle_states", "a mixture of controllers"),
        (spec.coordinates == "force", "coordinates", "force coordinates"),
    )
    for present, key, what in beside:
        if present:
            raise fault(
                f"{hands[0]!r} is a hand with a mass, which is not modelled beside {what}",
                f"remove {key}, or use a kelvin-voigt environment, which has no mass",
                key,
            )
    if spec.actuator.load_inertia is not None:
        raise fault(
            f"{hands[0]!r} is a hand with a mass, which is not modelled as a load of the motor",
            "remove load_inertia, or use a kelvin-voigt environment, which has no mass",
            "actuator",
            "load_inertia",
        )
    for name, controller in spec.controllers.items():
        Mt = controller.gains().get("Mt")
        if Mt is not None and not Mt.min.value:
            raise fault(
                f"{hands[0]!r} is a hand with a mass, whose force depends on itself where the "
                "admittance has no inertia",
                "give Mt a smallest value above zero",
                "controllers",
                name,
                "Mt",
            )
