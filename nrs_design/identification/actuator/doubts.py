"""What a fitted motor misses, and what that looks like."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from nrs_design.identification.actuator.motor import MotorModel
from nrs_design.identification.actuator.scan import tells_friction
from nrs_design.identification.actuator.time_fit import TimeFit
from nrs_design.identification.datasets.records import ActuatorRecord
from nrs_design.identification.held import Held
from nrs_design.identification.numeric import Array, beyond, column_sizes
from nrs_design.identification.statistics import WHITE

# A fit that misses more than this part of the output, in errors that are not white, has failed.
_MISSED = 0.01
# A cause is named where it alone explains so much of the power of the errors.
_EXPLAINS = 0.3
# Causes that explain the same to this part are all named.
_ALIKE = 0.01
# Of the largest command: where a driver may limit it.
_LEVELS = (0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
# Of the largest error: half the play that is tried.
_PLAYS = (0.5, 1.0, 1.5)
_LARGE = 0.1
# A relative standard error beyond which nothing is known.
_UNSURE = 0.5


def find_doubts(records: Sequence[ActuatorRecord], found: TimeFit) -> Iterator[str]:
    """Yield what speaks against a fit, with its evidence."""
    motor, step = found.motor, min(record.step for record in records)
    if motor.delay < -2 * float(found.uncertainty.errors[-1]):
        yield (
            f"the output comes {-motor.delay:.3g} s before its command "
            f"({-motor.delay / step:.2g} samples): the clocks of the columns "
            "differ, or command and output are swapped"
        )
    if motor.friction is None and not tells_friction(records, motor.time_constant, motor.delay):
        yield (
            "the command has one level only: friction cannot be told from a smaller gain, and the "
            "gain is that of this level"
        )
    names = ["gain", "time constant"] + ["friction"] * (motor.friction is not None)
    for name, error in zip(names, found.uncertainty.errors.tolist(), strict=False):
        if error > _UNSURE:
            yield f"the records do not determine the {name}: its relative error is {error:.2g}"
    spread = np.sqrt(sum(float(np.sum((r.output - r.output.mean()) ** 2)) for r in records))
    missed = float(np.linalg.norm(found.errors)) / spread
    if found.uncertainty.whiteness >= WHITE or missed <= _MISSED:
        return
    yield f"the model misses {100 * missed:.2g} % of the motion, in errors that are not noise"
    causes = sorted(_causes(records, found), reverse=True)
    if causes and causes[0][0] >= _EXPLAINS:
        share = causes[0][0]
        # Between two levels of a command, a limit and an offset do the same, but for rounding.
        alike = sorted((words for other, words in causes if other > share - _ALIKE), reverse=True)
        words = ", or ".join(alike)
        yield f"likely {words}; it alone would explain {100 * share:.0f} % of what is missed"


def _causes(records: Sequence[ActuatorRecord], found: TimeFit) -> Iterator[tuple[float, str]]:
    """Yield the part of the errors that each cause would explain, and its words."""
    motor = found.motor
    unit = records[0].unit
    largest = max(float(np.abs(record.command).max()) for record in records)
    limits = []
    for level in (share * largest for share in _LEVELS):
        share, factor = _explained(records, found, partial(_cut, motor, level))
        if factor < -_LARGE:
            limits.append((share, f"saturation: commands act as if cut at some {level:.3g} {unit}"))
    yield from sorted(limits)[-1:]
    share, factor = _explained(records, found, lambda r: motor.forced(r, *_constant(r)))
    yield share, f"an offset of some {factor:.3g} {unit} on the command"
    if not all(record.is_angle for record in records):
        return
    plays = []
    for play in (p * 2 * float(np.abs(found.errors).max()) for p in _PLAYS):
        share, factor = _explained(records, found, partial(_lost, motor, play))
        if factor > _LARGE:
            words = f"backlash: the output loses some {play * factor:.2g} rad at reversals"
            plays.append((share, words))
    yield from sorted(plays)[-1:]


def _explained(
    records: Sequence[ActuatorRecord], found: TimeFit, signature: Callable[[ActuatorRecord], Array]
) -> tuple[float, float]:
    """Return which part of the errors a signal explains, beside a better fit, and its factor."""
    x = np.concatenate([found.motor.beyond_start(record, signature(record)) for record in records])
    J = np.concatenate([found.motor.derivatives(record) for record in records])
    basis, _ = np.linalg.qr(J / column_sizes(J))
    x = beyond(basis, x)
    power = float(x @ x)
    if power == 0.0:
        return 0.0, 0.0
    factor = float(x @ found.errors) / power
    total = float(found.errors @ found.errors)
    return factor**2 * power / total if total else 0.0, factor


def _cut(motor: MotorModel, level: float, record: ActuatorRecord) -> Array:
    """Return the output of what a limit would cut off."""
    held, _ = motor.hold(record)
    over = held.command - np.clip(held.command, -level, level)
    return motor.forced(record, replace(held, command=over), None)


def _constant(record: ActuatorRecord) -> tuple[Held, None]:
    return Held(record.time, np.ones(len(record.time) - 1), np.arange(len(record.time))), None


def _lost(motor: MotorModel, play: float, record: ActuatorRecord) -> Array:
    """Return the output behind a play of a width, less that without it."""
    angle = motor.simulate(record)
    behind, followed = angle[0], []
    for value in angle.tolist():
        behind = min(max(behind, value - play / 2), value + play / 2)
        followed.append(behind)
    return np.array(followed) - angle
