"""What speaks against a fitted motor."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from nrs_design.identification.actuator.fit import ActuatorFit
from nrs_design.identification.actuator.scan import tells_friction
from nrs_design.identification.datasets.records import ActuatorRecord
from nrs_design.identification.statistics import WHITE

# A fit that misses more than this part of the output, in errors that are not white, has failed.
_MISSED = 0.01
# A relative standard error beyond which nothing is known.
_UNSURE = 0.5


def find_doubts(records: Sequence[ActuatorRecord], found: ActuatorFit) -> Iterator[str]:
    """Yield what speaks against a fit in time, with its evidence."""
    motor, step = found.motor, min(record.step for record in records)
    assert motor is not None
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
    if found.uncertainty.whiteness < WHITE and missed > _MISSED:
        yield (
            f"the model misses {100 * missed:.2g} % of the motion, in errors that are not noise, "
            "as of a second lag, a limit or an offset of the command, or backlash"
        )
