"""Where it can be asked for from which contact force motions decay although signals saturate."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.spec.faults import fault

if TYPE_CHECKING:
    from nrs_design.spec.interaction_parts import AbstractInteractionSpec

_AT = ("goals", "initial_force")


def check_initial_force(spec: AbstractInteractionSpec) -> None:
    """Report a fault if the goal `initial_force` is set where nothing can be claimed about it.

    Parameters
    ----------
    spec : AbstractInteractionSpec
        With its goals and limits.
    """
    if spec.goals is None or spec.goals.initial_force is None:
        return
    if spec.limits.command is None:
        raise fault(
            "nothing says where the command of the motor saturates",
            f"add `command` to the limits, in {spec.actuator.command}, for the error that the "
            "gains are for",
            *_AT,
        )
    for part, given, why in (
        ("sampling", spec.sampling is not None, "in continuous time only"),
        ("coupling", spec.coupling is not None, "for one axis only"),
        (
            "motion_loop.transfer_function",
            spec.motion_loop.transfer_function is not None,
            "where the PD controller and the motor are known apart",
        ),
        ("coordinates: force", spec.coordinates == "force", "in deflection coordinates"),
    ):
        if given:
            raise fault(
                f"decay although signals saturate is shown {why}",
                f"remove {part}, or the goal",
                *_AT,
            )
    if any(c.commands != "velocity" or "Kt" in c.gains() for c in spec.controllers.values()):
        raise fault(
            "decay although signals saturate is shown for impedance controllers without a spring "
            "Kt, and no others",
            "remove the goal, or the controllers of another type and Kt",
            *_AT,
        )
    if not all(
        isinstance(contact, str) for c in spec.controllers.values() for contact in c.contacts
    ):
        raise fault(
            "decay although signals saturate is shown for environments that are touched one by one",
            "let every contact be one environment, or remove the goal",
            *_AT,
        )
    for name in sorted(spec.touched & spec.environments.keys()):
        _check_environment(spec, name)


def _check_environment(spec: AbstractInteractionSpec, name: str) -> None:
    environment = spec.environments[name]
    if environment.remembers or environment.has_mass or environment.preloaded:
        raise fault(
            "decay although signals saturate is shown for elastic and damped environments, not "
            f"for {name!r}, which is {environment.model}",
            "let no controller touch it, or remove the goal",
            *_AT,
        )
    if spec.contact != "kept" and not environment.is_spring:
        raise fault(
            f"that contact with {name!r}, which has damping, is lost where signals saturate is not "
            "modelled",
            "write `contact: kept`, or use an elastic environment",
            *_AT,
        )
