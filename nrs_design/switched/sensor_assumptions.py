"""What a statement takes for granted about the force signal, in words."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.sensor import Sensor
from nrs_design.proof.bounds import rounded_up
from nrs_design.switched.assumption import Assumption
from nrs_design.switched.assumption_kinds import SENSOR


def sensor_texts(
    sensor: Sensor, period: Fraction | None, *, disturbed: bool
) -> Iterator[Assumption]:
    """Say how the law gets the force, and what a proof leaves out of its errors.

    Parameters
    ----------
    sensor : Sensor
        Of the design.
    period : Fraction or None
        Of the processor in s, where there is one.
    disturbed : bool
        Whether bounds on disturbances are stated.
    """
    if sensor.filter is not None:
        yield _filter_text(sensor, period)
    if sensor.errors:
        parts = "; ".join(f"{name}: {rounded_up(e, 'N*m')}" for name, e in sensor.errors.items())
        yield SENSOR.says(
            "What lasts of the errors of the force signal is a torque about the pivot of at most "
            f"{rounded_up(sensor.lasting, 'N*m')} ({parts}). {_OUTSIDE[disturbed]} In free motion "
            "an admittance without a spring integrates it, and the robot creeps.",
            f"{rounded_up(sensor.lasting, 'N*m')} about the pivot",
        )
    if sensor.carries:
        yield SENSOR.says(
            "The tool on the sensor acts on it by its weight alone, not by its acceleration.",
            "accelerations of the tool far below that of gravity",
        )
    if sensor.noise is not None:
        yield SENSOR.says("The noise of the force signal is left out: it has no bound.", "none")


_OUTSIDE = {
    False: "The statement leaves it out: a constant error moves the points of rest, and one that "
    "stays within the bound is a bounded input.",
    True: "It is the force error of the statements that name one; the others leave it out.",
}


def _filter_text(sensor: Sensor, period: Fraction | None) -> Assumption:
    assert sensor.filter is not None
    lags = "one lag" if sensor.filter.order == 1 else f"{sensor.filter.order} equal lags in a row"
    if period is None:
        return SENSOR.says(
            f"The law gets the force through {lags}, x' = w (F - x) with w = "
            f"{exact_decimal(sensor.filter.pole)} rad/s."
        )
    step = sensor.filter.sampled(period)
    return SENSOR.says(
        f"The law gets the force sample through {lags}, x+ = p x + q F with the single-precision "
        f"numbers p = {exact_decimal(step.p)} and q = {exact_decimal(step.q)}; it uses the x that "
        "is computed at the same sample."
    )
