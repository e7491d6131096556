"""From a spec to the goals of each controller, and where they are measured."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.gain_range import gain_interval
from nrs_design.design.goals import Requirement, corners_of
from nrs_design.design.measures import FORCE_MEASURES, IMPEDANCE_MEASURES, Measure
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.plant import Plant
from nrs_design.spec import (
    ForceControllerSpec,
    GainSpec,
    ImpedanceControllerSpec,
    InteractionDesignSpec,
    Quantity,
)


def requirement_of(
    spec: InteractionDesignSpec,
    plant: Plant,
    motion: TransferFunction,
    controller: ImpedanceControllerSpec | ForceControllerSpec,
) -> Requirement:
    """Collect the goals of one controller: the spec's own, replaced by those of the controller.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With the goals for all controllers.
    plant : Plant
        Its environments.
    motion : TransferFunction
        Closed motion loop G.
    controller : ImpedanceControllerSpec or ForceControllerSpec
        One of the spec's.
    """
    contacts = tuple(map(plant.environment, controller.contacts))
    if isinstance(controller, ForceControllerSpec):
        corners = corners_of(contacts, controller.environment, {})
        return Requirement(motion, corners, _goals(spec, controller, FORCE_MEASURES))
    gains = {"Mt": _ends(controller.Mt), "Bt": _ends(controller.Bt)}
    return Requirement(
        motion=motion,
        corners=corners_of(contacts, controller.environment, gains),
        goals=_goals(spec, controller, IMPEDANCE_MEASURES),
        desired=desired_impedance(spec, controller),
        bandwidth=spec.limits.bandwidth.si,
    )


def desired_impedance(spec: InteractionDesignSpec, controller: ImpedanceControllerSpec) -> float:
    """Return the desired impedance in N m s/rad, by default torque over velocity (thesis 6.2)."""
    if controller.desired_impedance is not None:
        return controller.desired_impedance.si
    ratio = controller.desired_impedance_ratio
    return (
        spec.limits.torque.si / spec.limits.velocity.si * (1.0 if ratio is None else float(ratio))
    )


def _goals(
    spec: InteractionDesignSpec,
    controller: ImpedanceControllerSpec | ForceControllerSpec,
    measures: tuple[Measure, ...],
) -> tuple[tuple[Measure, float], ...]:
    given: dict[str, Quantity | Fraction] = {}
    for goals in (spec.goals, controller.goals):
        given |= dict(goals.given()) if goals is not None else {}
    return tuple(
        (measure, _number(given[measure.goal])) for measure in measures if measure.goal in given
    )


def _number(value: Quantity | Fraction) -> float:
    return value.si if isinstance(value, Quantity) else float(value)


def _ends(gain: GainSpec) -> tuple[float, ...]:
    """Return the ends of a declared range of a gain, as single-precision numbers surround them."""
    if not gain.ranged:
        return ()
    interval = gain_interval(gain, to_float32(gain.min.exact))
    return (float(interval.low), float(interval.high))
