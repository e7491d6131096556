"""Assemble the exact switched system of a spec, its plant and the designed gains."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain
from typing import TYPE_CHECKING

from nrs_design.errors import AssemblyError, InternalError
from nrs_design.loop.assumptions import (
    GIVEN_MATRICES,
    assume,
    assume_constants,
    assume_data,
    assume_matrices,
    assume_preloads,
    assume_scale,
)
from nrs_design.loop.constraints import assemble_switching
from nrs_design.loop.located import (
    ConstantParameter,
    LocatedMode,
    Period,
    Spot,
    add_constants,
    constant_lateness,
    constants_of,
    grouped,
    labelled_ends,
    spot_of,
)
from nrs_design.models.axis import AxisType
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import combine
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import FixedParameter, Stay, Switching
from nrs_design.proof.system import SwitchedSystem

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.models.plant import Plant
    from nrs_design.spec import InteractionDesignSpec, Spec, SwitchedSystemSpec
    from nrs_design.spec.misses import MissesSpec
    from nrs_design.spec.switched_system import ModeSpec

__all__ = ["GIVEN_MATRICES", "assemble", "assemble_from_text", "assemble_matrices"]

UNSCALED = Fraction(1)
# Points of the ranges of a sampled loop.
ENDS, NOMINAL = "ends", "nominal"
POINTS = (ENDS, NOMINAL)
# Switches by a rule for misses.
MAX_TRANSITIONS = 200_000
SINGLE_STEP = Stay(Fraction(1), Fraction(1))


def assemble_from_text(
    spec: Spec,
    gains: Mapping[str, Mapping[str, str]],
    scale: Fraction = UNSCALED,
    plant: Plant | None = None,
    points: str = "",
) -> SwitchedSystem:
    """Assemble the switched system of a spec from the gains that a certificate quotes.

    A re-check reads these gains of a stranger, named as in `gains_of`, and holds them against the
    spec. Errors are those of `assemble`, and a `CertificateError` for gains that do not fit.
    """
    if spec.kind == "switched-system":
        if gains:
            raise AssemblyError("given matrices have no gains")
        if points:
            raise AssemblyError("the ranges of given matrices have no points")
        return assemble_matrices(spec, scale)
    if spec.kind == "robot":
        raise AssemblyError("a robot spec has no modes")
    from nrs_design.controllers.gains import design_from_gains
    from nrs_design.spec.build_plant import build_plant

    design = design_from_gains(spec, gains)
    plant = plant or build_plant(spec)
    return assemble(spec, plant, design, scale, points=points)


def assemble_matrices(spec: SwitchedSystemSpec, scale: Fraction = UNSCALED) -> SwitchedSystem:
    """Return the system of a spec of given matrices, one mode for each corner of its boxes."""
    _check_scale(scale)
    parameters = read_parameters(spec, scale)
    resets = ((r.source, r.target, RationalMatrix.from_rows(r.map)) for r in spec.resets)
    items = tuple(chain.from_iterable(corner_modes(mode, parameters) for mode in spec.modes))
    if spec.misses is not None:
        items, switching = modes_with_misses(items, spec.misses)
    else:
        switching = assemble_switching(spec.switching, grouped(items), resets)
    system = SwitchedSystem(
        name=spec.name,
        time=Time(spec.time),
        states=tuple(f"x{i + 1}" for i in range(spec.dimension)),
        modes=tuple(item.mode for item in items),
        assumptions=assume_matrices(spec, parameters, scale),
        switching=switching,
    )
    return add_constants(system, constant_parameters(parameters), items)


def read_parameters(spec: SwitchedSystemSpec, scale: Fraction) -> dict[str, Interval]:
    """Return the parameters of a spec, their ranges scaled about the nominal values."""
    return {
        name: Interval(p.nominal, *p.range, p.varies).scaled(scale)
        for name, p in spec.parameters.items()
    }


def constant_parameters(parameters: Mapping[str, Interval]) -> tuple[ConstantParameter, ...]:
    """Return the parameters that are unknown but constant."""
    return tuple(
        ConstantParameter(
            FixedParameter(name, interval.low, interval.high), (f"{name}-min", f"{name}-max")
        )
        for name, interval in parameters.items()
        if interval.is_constant
    )


def corner_modes(mode: ModeSpec, parameters: Mapping[str, Interval]) -> Iterator[LocatedMode]:
    """Yield the corners of one mode; parameters that it does not depend on make none.

    A matrix that is affine in the parameters is a convex combination of its corners everywhere in
    the box: what decreases in all corners in continuous time decreases in the whole box. An
    `InternalError` if the matrix halfway is not the mean of the corners.
    """
    ranges = {name: interval for name, interval in parameters.items() if name in mode.parameters}
    others = {name: interval.nominal for name, interval in parameters.items()}
    corners = [(labels, mode.matrix(others | values)) for labels, values in labelled_ends(ranges)]
    middle = mode.matrix({name: interval.middle for name, interval in parameters.items()})
    mean = combine(*((Fraction(1, len(corners)), [*chain(*A)]) for _, A in corners))
    if [*chain(*middle)] != mean:
        raise InternalError(f"mode {mode.name} is not affine in the parameters")
    constants = constant_parameters(parameters)
    for labels, A in corners:
        spot = Spot.from_names(mode.name) + spot_of(labels, ranges, constants)
        yield LocatedMode(mode.name, spot, "", Period(A))


def modes_with_misses(
    items: Sequence[LocatedMode], rule: MissesSpec
) -> tuple[tuple[LocatedMode, ...], Switching]:
    """Return the modes by the automaton state after them, and the allowed switches.

    A mode is named by the state that it leads to, such as ``miss/s3``, on which the next modes
    depend. Corners of one mode may take turns at every step. All groups but the miss are hits.
    """
    from nrs_design.spec.misses import automaton_of

    automaton = automaton_of(*rule.window)
    # Keys: whether the deadline is missed, and the state of the automaton after the step.
    groups: dict[tuple[bool, int], tuple[LocatedMode, ...]] = {}
    for missed, targets in ((False, automaton.hit), (True, automaton.miss)):
        corners = [item for item in items if (item.group == rule.mode) is missed]
        for target in sorted({t for t in targets if t is not None}):
            groups[missed, target] = tuple(
                replace(item, spot=item.spot + Spot.from_names(f"s{target}")) for item in corners
            )
    transitions: list[tuple[str, str]] = []
    dwells: list[tuple[str, Stay]] = []
    for (_, state), sources in groups.items():
        following = [(False, automaton.hit[state]), (True, automaton.miss[state])]
        after = [mode for missed, t in following if t is not None for mode in groups[missed, t]]
        names = {mode.name for mode in after}
        if (len(transitions) + len(sources) * len(after)) > MAX_TRANSITIONS:
            raise AssemblyError(
                f"the rule for misses makes more than {MAX_TRANSITIONS} switches",
                remedy="shorten its window, or declare fewer parameters",
                at=("misses",),
            )
        for source in sources:
            transitions += ((source.name, mode.name) for mode in after if mode is not source)
            if source.name not in names:
                dwells.append((source.name, SINGLE_STEP))
    modes = tuple(mode for corners in groups.values() for mode in corners)
    return modes, Switching(Fraction(1), tuple(transitions), stays=tuple(dwells))


def assemble(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    scale: Fraction = UNSCALED,
    *,
    points: str = "",
) -> SwitchedSystem:
    """Return the closed loop of an interaction design, one mode for each corner of its boxes.

    Every declared range is stretched by the scale about its nominal value; 0 leaves that alone. An
    `AssemblyError` if a number does not stay positive, or for too many switches.
    """
    from nrs_design.spec.build_plant import build_conditions

    _check_scale(scale)
    conditions = build_conditions(spec)
    if points and (points not in POINTS or conditions.sampling is None):
        raise AssemblyError(f"there is no system at the points {points!r} of the ranges")
    scale = Fraction(0) if points == NOMINAL else scale
    plant, sampling = plant.scaled(scale, conditions.contacted), conditions.sampling
    (drive,) = spec.drives
    sampled = sampling is not None
    constants = tuple(constants_of(plant, conditions.contacted, drive, sampled=sampled))
    if sampling is not None and conditions.constant_delay_key is not None:
        delay = conditions.constant_delay_key, conditions.command_delay, sampling.step
        constants = (*constants, constant_lateness(*delay))
    unit = spec.axis.unit
    constants = tuple(
        replace(c, fixed=replace(c.fixed, unit=unit(c.fixed.unit))) for c in constants
    )
    modes: Sequence[LocatedMode]
    if sampling is None:
        from nrs_design.loop.close_loop import close_loop

        system, modes = close_loop(conditions, plant, design, constants)
    else:
        from nrs_design.loop.system import close_sampled_loop

        system, modes = close_sampled_loop(
            conditions, plant, design, constants, points=bool(points)
        )
    system = add_constants(system, constants, modes)
    period = None if sampling is None else sampling.outer
    # Environments with memory stand at their nominal values at all points.
    has_memory = any(e.law.has_memory for e in plant.select_environments(design.contacts))
    but = points == ENDS and has_memory and "memory"
    disturbed = bool(system.channels) and period is not None
    assumptions = (
        *system.assumptions,
        *design.sensor.assumptions(period, disturbed=disturbed, axis=spec.axis),
        *assume_data(spec),
        *assume_preloads(conditions.preloads, scale),
        *assume_scale(scale),
        *((assume("range.points", points=points, but=but),) if points else ()),
        *assume_constants(system.switching),
    )
    return _convert_units(replace(system, assumptions=assumptions), spec.axis)


def _convert_units(system: SwitchedSystem, axis: AxisType) -> SwitchedSystem:
    """Name the units of an axis in the place of those of one that turns; no number changes."""
    if axis is AxisType.ROTARY:
        return system
    channels = tuple(replace(c, unit=axis.unit(c.unit)) for c in system.channels)
    outputs = tuple(replace(o, unit=axis.unit(o.unit)) for o in system.outputs)
    states = tuple(map(axis.label, system.states))
    return replace(system, states=states, channels=channels, outputs=outputs)


def _check_scale(scale: Fraction) -> None:
    if scale < 0:
        raise AssemblyError(f"ranges cannot be scaled by {scale}", remedy="give a scale >= 0")
