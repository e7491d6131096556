"""What makes an interaction design hard to prove, part by part, and the spec without a part.

A spec without a part allows for less, so what is proved of it is a part of what was asked for; but
for the sampling: without it, the law is taken to act at every moment, and without a period of its
own, the outer loop runs at every sample of the motion loop.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.quantity_fields import RangedQuantity

Weakening = Callable[[InteractionDesignSpec], InteractionDesignSpec]


def aspects_of(spec: InteractionDesignSpec) -> dict[str, Weakening]:
    """Return the parts of a spec that may be left out, in words, with how to leave them out."""
    found: dict[str, Weakening] = {}
    if spec.contact == "losable":
        found["the loss of contact"] = _with(contact="kept")
    if not (spec.actuator.gain.fixed and spec.actuator.time_constant.fixed):
        found["the ranges of the motor"] = _nominal_motor
    if any(not spec.environments[name].fixed for name in spec.touched):
        found["the ranges of what is touched"] = _nominal_environments
    if any(gain.ranged for c in spec.controllers.values() for gain in c.gains().values()):
        found["the ranges of gains"] = _nominal_gains
    if spec.sampling is not None:
        least, most = spec.sampling.delay
        if least < most:
            found["ages of the force sample beyond the shortest"] = partial(
                _resampled, delay=(least, least)
            )
        if spec.sampling.round > 1:
            found["the outer_period"] = with_common_period
    if spec.coupling is not None:
        found["what the axes do to each other"] = _with(coupling=None)
        if spec.sampling is not None and all(
            c.commands == "velocity" for c in spec.controllers.values()
        ):
            found["the sampling"] = _with(sampling=None)
    return found


def with_common_period(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    """Return the spec with the period of the motion loop for the outer loop, too.

    A delay that counted samples of the outer loop then counts these.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With sampling.
    """
    return _resampled(spec, outer_period=None)


def _with(**changes: object) -> Weakening:
    return lambda spec: spec.model_copy(update=changes)


def _resampled(spec: InteractionDesignSpec, **changes: object) -> InteractionDesignSpec:
    assert spec.sampling is not None
    return _with(sampling=spec.sampling.model_copy(update=changes))(spec)


def _nominal_motor(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    actuator = spec.actuator
    changes = {name: _nominal(getattr(actuator, name)) for name in ("gain", "time_constant")}
    return _with(actuator=actuator.model_copy(update=changes))(spec)


def _nominal_environments(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    def fixed(environment: Any) -> Any:
        changes = {key: _nominal(value) for key, value in environment.parameters().items()}
        return environment.model_copy(update=changes)

    changed: Mapping[str, Any] = {k: fixed(value) for k, value in spec.environments.items()}
    return _with(environments=changed)(spec)


def _nominal_gains(spec: InteractionDesignSpec) -> InteractionDesignSpec:
    def fixed(controller: Any) -> Any:
        gains = controller.gains().items()
        changes = {key: gain.model_copy(update={"range": None}) for key, gain in gains}
        return controller.model_copy(update=changes)

    changed = {name: fixed(controller) for name, controller in spec.controllers.items()}
    return _with(controllers=changed)(spec)


def _nominal(quantity: RangedQuantity) -> RangedQuantity:
    return quantity.model_copy(update={"range": (quantity.nominal, quantity.nominal)})
