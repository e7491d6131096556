"""The law that an export ships, as operations: from the same gains and the same sampling."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.float32 import float32_not_above
from nrs_design.controllers.operations import StepLaw, check_range
from nrs_design.controllers.sampled import (
    SampledAdmittance,
    SampledForce,
    SampledLaw,
    SampledMotion,
)
from nrs_design.controllers.sensor import SampledLowPass
from nrs_design.controllers.step_law import BEYOND, StepLimits, build_placed_law, build_step_law
from nrs_design.errors import DesignError
from nrs_design.exporters.export import Export
from nrs_design.spec import InteractionDesignSpec


def law_of(export: Export) -> StepLaw:
    """Return the law of an export that a processor runs.

    Raises
    ------
    DesignError
        If nothing may be exported, or a controller has no step yet.
    """
    record = export.shipped()
    assert export.spec is not None
    assert export.design is not None
    assert record.sample_time is not None
    return shipped_law(export.spec, export.design, Fraction(record.sample_time.exact))


def shipped_law(spec: InteractionDesignSpec, design: ControllerDesign, period: Fraction) -> StepLaw:
    """Write the law of a design out for a sample time.

    Parameters
    ----------
    spec : InteractionDesignSpec
        Its limits, and the method by which an admittance becomes a step.
    design : ControllerDesign
        Gains that ship.
    period : Fraction
        Sample time in s.

    Raises
    ------
    DesignError
        If a controller has no step yet, or a step could leave single precision.
    """
    method = "exact" if spec.sampling is None else spec.sampling.admittance
    sampled = {c.name: c.law.sampled(period, method) for c in design.controllers}
    low_pass = design.sensor.filter
    law = _step_law(
        spec,
        SampledMotion.of(design.motion, period),
        sampled,
        None if low_pass is None else low_pass.sampled(period),
    )
    check_range(law)
    return law


def _step_law(
    spec: InteractionDesignSpec,
    motion: SampledMotion,
    laws: Mapping[str, SampledLaw | None],
    low_pass: SampledLowPass | None,
) -> StepLaw:
    limits = limits_of(spec)
    moving = {name: law for name, law in laws.items() if isinstance(law, SampledAdmittance)}
    placed = {name: law for name, law in laws.items() if isinstance(law, SampledForce)}
    for name in laws.keys() - moving.keys() - placed.keys():
        raise _without_program(f"{name} is a {spec.controllers[name].type} controller", name)
    if moving and placed:
        both = f"{next(iter(placed))} stands beside impedance controllers"
        raise _without_program(both, next(iter(placed)))
    if spec.offset != "none":
        raise _without_program("force control takes an offset", next(iter(placed)))
    if placed:
        return build_placed_law(motion, placed, low_pass, limits)
    if len({law.a is None for law in moving.values()}) > 1:
        raise DesignError(
            "some impedance controllers have a virtual inertia and some have none",
            remedy="give all of them an inertia Mt > 0, or none",
            at=("controllers",),
        )
    return build_step_law(motion, moving, low_pass, limits)


def _without_program(what: str, controller: str) -> DesignError:
    return DesignError(
        f"{what}, of which there is no program",
        remedy="export the gains alone, with --format json",
        at=("controllers", controller),
    )


def limits_of(spec: InteractionDesignSpec) -> StepLimits:
    """Return the limits of a spec in single precision, none of them above what is written.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With a largest angle and a largest speed command, or without.
    """
    angle, command = BEYOND, spec.limits.command
    if spec.disturbances is not None and spec.disturbances.largest_angle is not None:
        angle = float32_not_above(spec.disturbances.largest_angle.not_above)
    return StepLimits(
        angle,
        float32_not_above(spec.limits.velocity.not_above),
        None if command is None else float32_not_above(command.not_above),
    )
