"""Where it can be asked for that contact settles under a constant force."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.spec.faults import fault

if TYPE_CHECKING:
    from nrs_design.spec.interaction_parts import AbstractInteractionSpec

_AT = ("goals", "constant_force")


def check_constant_force(spec: AbstractInteractionSpec) -> None:
    """Report a fault if the goal `constant_force` is set where nothing can be claimed about it.

    The loop must rest at one deflection under every controller, where the force alone moves the
    admittances.

    Parameters
    ----------
    spec : AbstractInteractionSpec
        With its goals.
    """
    if spec.goals is None or spec.goals.constant_force is None:
        return
    if spec.contact != "losable":
        raise fault(
            "that contact settles under a constant force is shown through its loss",
            "write `contact: losable`",
            *_AT,
        )
    for part, given, why in (
        ("sampling", spec.sampling is not None, "in continuous time only"),
        ("coupling", spec.coupling is not None, "for one axis only"),
        (
            "actuator.load_inertia",
            spec.actuator.load_inertia is not None,
            "where what is touched does not load the motor",
        ),
    ):
        if given:
            raise fault(
                f"that contact settles under a constant force is shown {why}",
                f"remove {part}, or the goal",
                *_AT,
            )
    contacts = {contact for c in spec.controllers.values() for contact in c.contacts}
    if len(contacts) != 1 or not all(isinstance(contact, str) for contact in contacts):
        raise fault(
            "a constant force settles at one deflection in one environment: another stiffness "
            "moves it",
            "let all controllers touch the same environment and no other, or remove the goal",
            *_AT,
        )
    (name,) = spec.touched
    # One that is not there is a fault of its own.
    if name in spec.environments and not spec.environments[name].is_spring:
        raise fault(
            f"that contact settles under a constant force is shown for springs, not for {name!r}",
            "use an elastic environment without damping, or remove the goal",
            *_AT,
        )
    if spec.flies_like_a_mode:
        raise fault(
            "with a spring Kt a constant force has to hold the admittance, too, wherever it rests",
            "remove Kt, or the goal",
            *_AT,
        )
