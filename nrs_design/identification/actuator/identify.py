"""The actuator from all the data there are."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.errors import DataError
from nrs_design.identification.actuator.doubts import find_doubts
from nrs_design.identification.actuator.frequency_fit import fit_phasors, fit_response
from nrs_design.identification.actuator.model import FROM_THE_ROW, ActuatorFit, MotorFigures, fit_of
from nrs_design.identification.actuator.phasors import Phasors, phasors_of
from nrs_design.identification.actuator.scan import longest_delay, scan_motor
from nrs_design.identification.actuator.time_fit import TimeFit, fit_in_time
from nrs_design.identification.datasets.checks import doubt_step
from nrs_design.identification.datasets.records import ActuatorRecord, FrequencyResponse
from nrs_design.identification.numeric import Array, Complex
from nrs_design.identification.statistics import WHITE, Estimate, span
from nrs_design.identification.tables.table import Source
from nrs_design.identification.tissue.ranges import check_spread, spread_ranges
from nrs_design.models.actuator import MotorConstants
from nrs_design.progress import Progress, silent
from nrs_design.spec.plausible import doubt_size
from nrs_design.spec.provenance import MOTOR_COVERS, Coverage

# A second order must explain so much of what the first misses.
_WORTHWHILE = 0.2


UNDETERMINED = (
    "the records do not determine the dead time: it may be a tenth of a record, or longer (record "
    "steps, or more samples of fast motions)"
)


@dataclass(frozen=True, slots=True, eq=False)
class ActuatorIdentification:
    """Fits of one actuator."""

    sources: tuple[Source, ...]  # The files
    fits: tuple[ActuatorFit, ...]  # Every method that the data allow
    chosen: ActuatorFit  # One of them
    reason: str  # Why that one
    # Derived from it and the data sheet, which are about commands in rpm.
    figures: MotorFigures | None
    frequency: Array  # Shape (m,). In rad/s.
    # Shape (m,). Velocity over command without friction, in rad/s per unit of the command; empty
    # where records are no sinusoids.
    response: Complex
    doubts: tuple[str, ...]  # What the model misses, and what that looks like
    ranges: tuple[Estimate, ...]  # Of gain and time constant, for a spec
    records: tuple[ActuatorRecord, ...] = ()  # None for a ready response
    unit: str = "rpm"  # Of the command
    step: float | None = None  # Usual time between samples in s; None for a ready response
    coverage: Coverage = "confidence"  # What the ranges hold

    @property
    def covers(self) -> str:
        """What the ranges hold, in words."""
        return MOTOR_COVERS[self.coverage]

    @property
    def remarks(self) -> tuple[str, ...]:
        """How pauses part records, in words."""
        return tuple(f"{r.name}: {r.pauses}" for r in self.records if r.pauses)

    @property
    def late(self) -> Estimate | None:
        """The dead time in s, where it is clearly above zero."""
        late = self.chosen.dead_time
        return None if late is None or late.low == 0.0 else late

    @property
    def caveats(self) -> tuple[str, ...]:
        """Doubts, and a dead time, for a spec that has no place for it."""
        if self.chosen.motor is not None and self.chosen.dead_time is None:
            return (*self.doubts, UNDETERMINED)
        if self.late is None:
            return self.doubts
        wide = self.late.outward(3)
        return (
            *self.doubts,
            f"the motor has a dead time of {span(wide.low, wide.high, 's')} ({FROM_THE_ROW}), "
            "which the proof leaves out: it acts on the motion loop, so that it is no part of "
            "sampling.delay (the age of the force sample)",
        )


def identify_actuator(
    data: Sequence[ActuatorRecord | FrequencyResponse],
    motor: MotorConstants,
    coverage: Coverage = "confidence",
    progress: Progress = silent,
) -> ActuatorIdentification:
    """Fit gain, time constant, friction and dead time to records, or to one frequency response.

    The ranges for a spec hold the recorded motor, or (coverage by tolerance or prediction) others
    too, which takes more than one record; else `DataError`.
    """
    if coverage != "confidence":
        check_spread(coverage, len({_origin(item) for item in data}))
    responses = [item for item in data if isinstance(item, FrequencyResponse)]
    records = [item for item in data if isinstance(item, ActuatorRecord)]
    if not data or (responses and records) or len(responses) > 1:
        raise DataError(
            f"{len(records)} records and {len(responses)} frequency responses",
            remedy="give records of the motor, or one frequency response",
        )
    if len({(*_origin(r), r.part) for r in records}) < len(records):
        raise DataError(
            "a record is there twice, which would narrow the intervals", remedy="name it once"
        )
    units = {record.unit for record in records}
    if len(units) > 1:
        raise DataError(
            f"the commands are in {' and '.join(sorted(units))}",
            remedy="give records of one driver",
        )
    progress("complex response")
    if responses:
        return _from_response(responses[0], motor)
    found = _from_records(records, motor, progress)
    if coverage == "confidence":
        return found
    progress("each record by itself")
    return replace(found, coverage=coverage, ranges=_spread(records, coverage))


def _spread(records: Sequence[ActuatorRecord], coverage: Coverage) -> tuple[Estimate, ...]:
    """Return ranges that hold other records, from a fit to each of these by itself."""
    wholes: dict[tuple[str, str], list[ActuatorRecord]] = {}
    for record in records:
        wholes.setdefault(_origin(record), []).append(record)
    fits = [fit_of(parts[0].name, _alone(parts), longest_delay(parts)) for parts in wholes.values()]
    single = [(fit.gain, fit.time_constant) for fit in fits]
    logarithms = np.log([[estimate.value for estimate in row] for row in single])
    return spread_ranges(coverage, logarithms, single)


def _origin(item: ActuatorRecord | FrequencyResponse) -> tuple[str, str]:
    """Return what stretches between pauses of one record have in common."""
    return item.source.sha256, item.group if isinstance(item, ActuatorRecord) else ""


def _alone(parts: Sequence[ActuatorRecord]) -> TimeFit:
    try:
        return _first_order(parts)
    except DataError as error:
        raise DataError(
            f"{parts[0].name} alone does not determine the motor: {error.message}",
            path=parts[0].source.path,
            remedy="give records that each do, such as steps or chirps; or leave --covers out",
        ) from None


def _from_response(data: FrequencyResponse, motor: MotorConstants) -> ActuatorIdentification:
    fit = fit_response(data)
    return ActuatorIdentification(
        sources=(data.source,),
        fits=(fit,),
        chosen=fit,
        reason="A ready response allows nothing else; friction cannot be told from it.",
        figures=fit.figures(motor),
        ranges=fit.ranges,
        frequency=data.frequency,
        response=data.response,
        doubts=_slips(fit, data.unit, None),
    )


def _from_records(
    records: Sequence[ActuatorRecord], motor: MotorConstants, progress: Progress
) -> ActuatorIdentification:
    phasors, fits = _from_phasors(records)
    progress("time domain")
    found = _first_order(records)
    longest = longest_delay(records)
    fits.append(fit_of("output in the time domain", found, longest))
    reason = "The fit to the output uses every sample."
    if found.uncertainty.whiteness < WHITE:
        progress("second order")
        second = _second_order(records, found)
        if second is not None:
            fits = [*fits, fit_of("second order, in the time domain", second, longest)]
            found = second
            reason = "The motor of first order fails; that of second order explains more."
    chosen, step = fits[-1], min(record.step for record in records)
    return ActuatorIdentification(
        sources=tuple({record.source.sha256: record.source for record in records}.values()),
        records=tuple(records),
        fits=tuple(fits),
        chosen=chosen,
        reason=reason,
        figures=chosen.figures(motor) if records[0].unit == "rpm" and chosen.order == 1 else None,
        frequency=np.array([p.frequency for p in phasors]),
        response=_response(phasors, chosen),
        doubts=(
            *_slips(chosen, records[0].unit, step),
            *find_doubts(records, found),
        ),
        unit=records[0].unit,
        ranges=chosen.ranges,
        step=step,
    )


def _slips(fit: ActuatorFit, unit: str, step: float | None) -> tuple[str, ...]:
    """Return what is asked about the sizes of what was found, and of the steps of time."""
    said = [] if step is None else [*doubt_step(step)]
    for name, value, si in (
        ("gain", fit.gain.value, f"rad/s/{unit}"),
        ("time_constant", fit.time_constant.value, "s"),
    ):
        if asked := doubt_size(name, value, si):
            said.append(f"the {name.replace('_', ' ')} is {value:.4g} {si}: {asked}")
    return tuple(said)


def _from_phasors(records: Sequence[ActuatorRecord]) -> tuple[list[Phasors], list[ActuatorFit]]:
    """Return amplitudes and the fit to them, where the records are sinusoids."""
    phasors: list[Phasors] = []
    for record in records:
        if (found := phasors_of(record)) is None:
            return [], []
        phasors.append(found)
    fit = fit_phasors(phasors)
    return phasors, [] if fit is None else [fit]


def _response(phasors: Sequence[Phasors], fit: ActuatorFit) -> Complex:
    friction = fit.friction.value if fit.friction else 0.0
    V = np.array([p.velocity for p in phasors])
    U = np.array([p.command for p in phasors])
    return np.asarray(V / (U - 4 / np.pi * friction * V / np.abs(V)))


def _first_order(records: Sequence[ActuatorRecord]) -> TimeFit:
    """Return a motor of first order, with friction only where that is better.

    The scan may find friction where there is none, as its times are coarse.
    """
    start = scan_motor(records)
    if start.friction is None:
        return fit_in_time(records, start)
    without = replace(start, friction=None)
    try:
        found = fit_in_time(records, start)
    except DataError:
        return fit_in_time(records, without)
    if found.uncertainty.whiteness >= WHITE and found.tells_friction:
        return found
    try:
        return min(found, fit_in_time(records, without), key=lambda fit: fit.bic)
    except DataError:
        return found


def _second_order(records: Sequence[ActuatorRecord], first: TimeFit) -> TimeFit | None:
    """Return a motor of second order if it explains clearly more."""
    tried = []
    for damping in (1.5, 0.4):
        with suppress(DataError):
            tried.append(fit_in_time(records, replace(first.motor, damping=damping)))
    best = min(tried, key=lambda fit: fit.bic, default=first)
    before = float(first.errors @ first.errors)
    return best if float(best.errors @ best.errors) <= (1 - _WORTHWHILE) * before else None
