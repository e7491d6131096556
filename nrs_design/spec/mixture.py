"""Controllers of several kinds in one spec: what must be said, and what is not modelled."""

from __future__ import annotations

from nrs_design.spec.controllers import ControllerSpec, IdleStatesSpec, Offset
from nrs_design.spec.environment import EnvironmentSpec
from nrs_design.spec.faults import fault


def check_mixture(
    controllers: dict[str, ControllerSpec],
    environments: dict[str, EnvironmentSpec],
    idle: IdleStatesSpec | None,
    coordinates: str,
) -> None:
    """Refuse states of impedance and pi-force controllers that nobody says what to do with.

    Other controllers do not use them.

    Parameters
    ----------
    controllers, environments : dict
        By name.
    idle : IdleStatesSpec, optional
        What these states do while another kind of controller is active.
    coordinates : {"deflection", "force"}
        State of the contact.
    """
    first_name, first = next(iter(controllers.items()))
    others = (
        (name, controller.type)
        for name, controller in controllers.items()
        if controller.commands != first.commands
    )
    name, kind = next(others, (None, None))
    whose = "impedance" if name is not None else "pi-force"
    bleeding = _bleeding(controllers)
    if name is None and bleeding is not None:
        name, kind = bleeding, controllers[bleeding].type
    if idle is None and name is not None:
        raise fault(
            f"{kind} is mixed with {first.type} ({first_name!r}), and it is not said what the "
            f"states of {whose} controllers do meanwhile",
            "add `idle_states: {decay: 20 1/s}`, or use one kind of controller",
            "controllers",
            name,
            "type",
        )
    if idle is None:
        return
    if name is None:
        raise fault(
            "idle_states without impedance controllers beside position or force controllers, or "
            "pi-force controllers beside others",
            "remove idle_states",
            "idle_states",
        )
    if idle.reset and bleeding is not None:
        raise fault(
            f"the integral of {bleeding!r} bleeds, so that the command does not jump: a reset of "
            "it is not modelled",
            "remove reset",
            "idle_states",
            "reset",
        )
    if coordinates == "force":
        raise fault(
            "force coordinates do not apply to impedance controllers beside others",
            "use `coordinates: deflection`",
            "coordinates",
        )
    for contact, environment in environments.items():
        if environment.remembers:
            raise fault(
                f"{contact!r}, which is {environment.model}, is not modelled beside idle_states: "
                "where controllers have states that others do not",
                "use elastic or kelvin-voigt environments, or one kind of controller",
                "environments",
                contact,
                "model",
            )


def _bleeding(controllers: dict[str, ControllerSpec]) -> str | None:
    """Return a controller with an integral that others leave to bleed, if there is one."""
    if len({controller.bleeds for controller in controllers.values()}) < 2:
        return None
    return next(name for name, controller in controllers.items() if controller.bleeds)


def check_offsets(controllers: dict[str, ControllerSpec], idle: IdleStatesSpec | None) -> None:
    """Refuse offsets that differ, and offsets where impedance controllers integrate a reference."""
    first: tuple[str, Offset] | None = None
    for name, controller in controllers.items():
        if (offset := controller.own_offset) is None:
            continue
        at = ("controllers", name, "offset")
        if idle is not None and offset != "none":
            raise fault(
                "an offset is not modelled for force controllers beside impedance controllers or "
                f"pi-force controllers ({name!r} has offset {offset})",
                "leave offset out, or write a spec without impedance and pi-force controllers",
                *at,
            )
        first = first or (name, offset)
        if offset != first[1]:
            raise fault(
                f"{name!r} has offset {offset}, {first[0]!r} has {first[1]}: one state "
                "cannot hold both",
                f"give all force controllers `offset: {first[1]}`",
                *at,
            )
