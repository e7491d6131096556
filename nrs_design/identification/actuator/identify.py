"""The actuator from all the data there are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from nrs_design.identification.actuator.fit import (
    DEAD_TIME_NOTE,
    ActuatorFit,
    fit_in_time,
    scan_motor,
    tells_friction,
)
from nrs_design.identification.datasets.records import (
    AbstractIdentification,
    SignalRecord,
    doubt_step,
    question_sizes,
)
from nrs_design.identification.errors import DataError
from nrs_design.identification.statistics import WHITE, Estimate, span
from nrs_design.spec.provenance import MOTOR_COVERS

UNDETERMINED = (
    "the records do not determine the dead time: it may be a tenth of a record, or longer (record "
    "steps, or more samples of fast motions)"
)

# First guess of a friction that a scan does not see, as a part of the largest command.
_GUESS = 0.05
# Largest relative error of a fit with colored residuals that raises no doubt.
_MISSED = 0.01
# Relative standard error beyond which a parameter is undetermined.
_UNSURE = 0.5


@dataclass(frozen=True, eq=False)
class ActuatorIdentification(AbstractIdentification[SignalRecord]):
    """Motor identified from records, with intervals and doubts."""

    fit: ActuatorFit  # The motor

    @cached_property
    def doubts(self) -> tuple[str, ...]:
        """Evidence against the fit."""
        fit = self.fit
        sizes = (
            ("gain", "the gain", fit.gain.value, f"rad/s/{self.unit}"),
            ("time_constant", "the time constant", fit.time_constant.value, "s"),
        )
        return (*doubt_step(self.step), *question_sizes(sizes), *find_doubts(self.records, fit))

    @property
    def unit(self) -> str:
        """Unit of the command."""
        return self.records[0].unit

    @property
    def step(self) -> float:
        """Usual time between samples in s."""
        return min(record.step for record in self.records)

    @property
    def covers(self) -> str:
        """Coverage of the ranges, in words."""
        return MOTOR_COVERS["confidence"]

    @property
    def clear_dead_time(self) -> Estimate | None:
        """The dead time in s, where it is clearly above zero."""
        estimate = self.fit.dead_time
        return None if estimate is None or estimate.low == 0.0 else estimate

    @property
    def caveats(self) -> tuple[str, ...]:
        """Doubts, and a dead time, for a spec that has no place for it."""
        if self.fit.dead_time is None:
            return (*self.doubts, UNDETERMINED)
        if self.clear_dead_time is None:
            return self.doubts
        wide = self.clear_dead_time.outward(3)
        return (
            *self.doubts,
            f"the motor has a dead time of {span(wide.low, wide.high, 's')} ({DEAD_TIME_NOTE}). "
            "The proof leaves out this dead time of the motion loop, which is not part of "
            "sampling.delay (the age of the force sample)",
        )


def identify_actuator(records: Sequence[SignalRecord]) -> ActuatorIdentification:
    """Fit gain, time constant, friction and dead time to records.

    The ranges for a spec hold the recorded motor, and no other.
    """
    _check(records)
    return ActuatorIdentification(tuple(records), _fit(records))


def _check(records: Sequence[SignalRecord]) -> None:
    if not records:
        raise DataError("there are no records", remedy="name at least one CSV file")
    if len({record.source.sha256 for record in records}) < len(records):
        raise DataError(
            "a record is there twice, which would narrow the intervals", remedy="name it once"
        )
    units = {record.unit for record in records}
    if len(units) > 1:
        raise DataError(
            f"the commands are in {' and '.join(sorted(units))}",
            remedy="give records of one driver",
        )


def _fit(records: Sequence[SignalRecord]) -> ActuatorFit:
    """Return a motor with friction only where that is better.

    The scan may find friction where there is none, and none where there is some: it is coarse.
    """
    start = scan_motor(records)
    frictionless = replace(start, friction=None)
    friction = start.friction
    if friction is None:
        if not tells_friction(records, start.time_constant, start.delay):
            return fit_in_time(records, frictionless)
        friction = _GUESS * max(float(np.abs(record.command).max()) for record in records)
    try:
        fit = fit_in_time(records, replace(start, friction=friction))
    except DataError:
        return fit_in_time(records, frictionless)
    if fit.uncertainty.whiteness >= WHITE and fit.tells_friction:
        return fit
    try:
        return min(fit, fit_in_time(records, frictionless), key=lambda fit: fit.bic)
    except DataError:
        return fit


def find_doubts(records: Sequence[SignalRecord], fit: ActuatorFit) -> Iterator[str]:
    """Yield what speaks against a fit in time, with its evidence."""
    motor, step = fit.motor, min(record.step for record in records)
    if motor.delay < -2 * float(fit.uncertainty.errors[-1]):
        yield (
            f"the output comes {-motor.delay:.3g} s before its command "
            f"({-motor.delay / step:.2g} samples): the clocks of the columns "
            "differ, or command and output are swapped"
        )
    if motor.friction is None and not tells_friction(records, motor.time_constant, motor.delay):
        yield (
            "the command has one level only: friction and a smaller gain are indistinguishable, "
            "and the gain holds for this level"
        )
    names = ["gain", "time constant"] + ["friction"] * (motor.friction is not None)
    for name, error in zip(names, fit.uncertainty.errors.tolist(), strict=False):
        if error > _UNSURE:
            yield f"the records do not determine the {name}: its relative error is {error:.2g}"
    motion = np.sqrt(sum(float(np.sum((r.output - r.output.mean()) ** 2)) for r in records))
    missed = float(np.linalg.norm(fit.errors)) / motion
    if fit.uncertainty.whiteness < WHITE and missed > _MISSED:
        yield (
            f"the model misses {100 * missed:.2g} % of the motion, in errors that are not noise, "
            "as of a second lag, a limit or an offset of the command, or backlash"
        )
