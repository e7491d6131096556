"""What makes an interaction design hard to prove, part by part, and the spec without a part.

A spec without a part allows for less, so what is proved of it is a part of what was asked for; but
for the sampling: without it, the law is taken to act at every moment, and without a period of its
own, the outer loop runs at every sample of the motion loop.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.quantity_fields import RangedQuantity

Weakening = Callable[[InteractionDesignSpec], InteractionDesignSpec]


def aspects_of(spec: InteractionDesignSpec) -> dict[str, Weakening]:
    """Return the parts of a spec that may be left out, in words, with how to leave them out."""
    found: dict[str, Weakening] = {}
    if spec.contact == "losable":
        found["the loss of contact"] = _without_loss
    if not (spec.actuator.gain.fixed and spec.actuator.time_constant.fixed):
        found["the ranges of the motor"] = _nominal_motor
    if any(not spec.environments[name].fixed for name in spec.touched):
        found["the ranges of what is touched"] = _nominal_environments
    if any(gain.ranged for c in spec.controllers.values() for gain in c.gains().values()):
        found["the ranges of gains"] = _nominal_gains
    if spec.sampling is not None and spec.sampling.delay[0] < spec.sampling.delay[1]:
        found["ages of the force sample beyond the shortest"] = _shortest_delay
    if spec.sampling is not None and spec.sampling.round > 1:
        found["the outer_period"] = with_common_period
    if spec.coupling is not None:
        found["what the axes do to each other"] = _without_coupling
        if spec.sampling is not None and all(
            c.commands == "velocity" for c in spec.controllers.values()
        ):
            found["the sampling"] = _without_sampling
    return found


def with_common_period(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    """Return the spec with the period of the motion loop for the outer loop, too.

    A delay that counted samples of the outer loop then counts these.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With sampling.
    """
    assert spec.sampling is not None
    changed = spec.sampling.model_copy(update={"outer_period": None})
    return spec.model_copy(update={"sampling": changed})


def _without_sampling(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    return spec.model_copy(update={"sampling": None})


def _without_coupling(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    return spec.model_copy(update={"coupling": None})


def _without_loss(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    return spec.model_copy(update={"contact": "kept"})


def _nominal_motor(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    actuator = spec.actuator
    changes = {name: _nominal(getattr(actuator, name)) for name in ("gain", "time_constant")}
    return spec.model_copy(update={"actuator": actuator.model_copy(update=changes)})


def _nominal_environments(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    def fixed(environment: Any) -> Any:
        changes = {key: _nominal(value) for key, value in environment.parameters().items()}
        return environment.model_copy(update=changes)

    changed: Mapping[str, Any] = {k: fixed(value) for k, value in spec.environments.items()}
    return spec.model_copy(update={"environments": changed})


def _nominal_gains(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    def fixed(controller: Any) -> Any:
        gains = controller.gains().items()
        changes = {key: gain.model_copy(update={"range": None}) for key, gain in gains}
        return controller.model_copy(update=changes)

    changed = {name: fixed(controller) for name, controller in spec.controllers.items()}
    return spec.model_copy(update={"controllers": changed})


def _shortest_delay(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    sampling = spec.sampling
    assert sampling is not None
    least = sampling.delay[0]
    changed = sampling.model_copy(update={"delay": (least, least)})
    return spec.model_copy(update={"sampling": changed})


def _nominal(quantity: RangedQuantity) -> RangedQuantity:
    return quantity.model_copy(update={"range": (quantity.nominal, quantity.nominal)})
