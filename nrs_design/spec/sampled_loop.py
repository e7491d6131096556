"""What the sampled loop does not model yet: said while a spec is read, at its place."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING

from nrs_design.spec.faults import all_of, fault
from nrs_design.spec.sampling import LARGEST_RATIO

if TYPE_CHECKING:
    from nrs_design.spec.interaction_parts import AbstractInteractionSpec

# Place, what is not modelled, and what to do.
Refusal = tuple[tuple[str, ...], str, str]


def check_sampled(spec: AbstractInteractionSpec) -> None:
    """Refuse what is not modelled beside `sampling`, all of it at once."""
    if spec.sampling is None:
        return
    if (odd := spec.sampling.find_odd_periods()) is not None:
        form = f"give 1 to {LARGEST_RATIO} periods of one loop to a period of the other"
        raise fault(odd, form, "sampling", "outer_period")
    all_of(*(partial(_refuse, *refusal) for refusal in _not_modelled(spec)))


def _refuse(at: tuple[str, ...], what: str, remedy: str) -> None:
    raise fault(f"in the sampled loop, {what}: not modelled", remedy, *at)


def _not_modelled(spec: AbstractInteractionSpec) -> Iterator[Refusal]:
    yield from _controllers(spec)
    if spec.sampling is not None and spec.sampling.round > 1:
        yield from _two_periods(spec)
    for name in sorted(spec.touched & spec.environments.keys()):
        if spec.environments[name].remembers:
            remedy = "use elastic or kelvin-voigt environments, or leave sampling out"
            yield ("environments", name, "model"), f"{name} remembers", remedy
    if spec.motion_loop.transfer_function is not None:
        what = "the spec states the closed motion loop in continuous time"
        yield ("motion_loop", "transfer_function"), what, "leave transfer_function or sampling out"
    if spec.coordinates == "force":
        yield ("coordinates",), "force coordinates", "use `coordinates: deflection`"
    yield from _loss_of_contact(spec)
    rounds = spec.disturbances is not None and spec.disturbances.largest_angle is not None
    if rounds and spec.idle_states is not None:
        # The position is added to the reference at every sample, which rounds an angle once more.
        what = "the rounding of angles beside idle_states"
        yield ("disturbances", "largest_angle"), what, "leave largest_angle out"
    # Rules about controllers in one contact each are refused as a whole elsewhere.
    times = () if spec.switching.names_contacts else spec.switching.dwell_times()
    for at, _ in times:
        what = "dwell times in the rules of switching"
        yield ("switching", *at), what, "leave them out, or sampling"


def _two_periods(spec: AbstractInteractionSpec) -> Iterator[Refusal]:
    """Refuse what is not modelled where the outer loop has a period of its own."""
    at = ("sampling", "outer_period")
    others = [name for name, c in spec.controllers.items() if c.commands != "velocity"]
    if others:
        what = f"an outer_period beside {others[0]}, which is no impedance controller"
        yield at, what, "leave outer_period out"
    if not spec.switching.is_arbitrary:
        what = "rules of switching beside an outer_period"
        yield ("switching",), what, "use `switching: arbitrary`, which allows for more"


def _controllers(spec: AbstractInteractionSpec) -> Iterator[Refusal]:
    commanded = spec.disturbances is not None and spec.disturbances.command is not None
    for name, controller in spec.controllers.items():
        at = ("controllers", name)
        if not controller.sampled:
            remedy = "use impedance, position and force controllers, or leave sampling out"
            yield (*at, "type"), f"{name} is a {controller.type} controller", remedy
        if spec.offset != "none" and controller.own_offset is not None:
            what = f"the offset of {name}, which leaves a mode at rest anywhere"
            yield (*at, "offset"), what, "use `offset: none`, or leave sampling out"
        if commanded and controller.commands == "position":
            what = f"the velocity command beside {name}, which is given a position"
            yield ("disturbances", "command"), what, "leave command out"
        if commanded and "Kt" in controller.gains():
            what = f"a velocity command moves the position that the spring Kt of {name} draws to"
            yield ("disturbances", "command"), what, "leave command out, or Kt"


def _loss_of_contact(spec: AbstractInteractionSpec) -> Iterator[Refusal]:
    if spec.contact != "losable":
        return
    bleeding = next((name for name, c in spec.controllers.items() if c.bleeds), None)
    if bleeding is not None:
        what = f"loss of contact under {bleeding}, whose integral a force has to balance"
        yield ("contact",), what, "use `contact: kept`"
    elif spec.idle_states is not None:
        what = "loss of contact under impedance controllers beside others"
        yield ("contact",), what, "use `contact: kept`, or one kind of controller"
    if len({"Kt" in controller.gains() for controller in spec.controllers.values()}) > 1:
        what = "loss of contact where some controllers have a spring Kt and some have none"
        yield ("contact",), what, "use `contact: kept`, or give all of them a spring"
