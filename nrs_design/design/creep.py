"""Creep: the motion of a robot that nothing touches, by lasting errors of its force signal.

An admittance without a spring integrates them: an error F0 becomes the velocity ``F0/Bt``. A spring
ends the creep at the angle ``F0/Kt``. Exact numbers, none too small: bounds for a constant error,
after what has been moved by others has settled.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from nrs_design.controllers.controller_design import Controller
from nrs_design.controllers.gain_range import gain_interval
from nrs_design.controllers.laws.impedance import lasting_gain
from nrs_design.controllers.sensor import Sensor, build_sensor
from nrs_design.design.goals import Achieved
from nrs_design.design.measures import CREEP, CREEP_ANGLE
from nrs_design.design.transfer import trim, white_noise_power
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.proof.bounds import upper_float
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.controllers import AbstractControllerSpec


@dataclass(frozen=True, slots=True)
class Creep:
    """How a controller moves the robot in free motion."""

    velocity: Fraction  # Bound on the lasting velocity in rad/s; zero with a spring
    # Bound on the angle in rad; None without a spring, where it grows as long as the error lasts.
    angle: Fraction | None
    # Standard deviation of the velocity of the admittance in rad/s by the noise of the sensor; None
    # where nothing is said of noise, or where it has no bound.
    noise: float | None


def creep_of(
    spec: InteractionDesignSpec,
    loop: MotionLoop,
    given: AbstractControllerSpec,
    controller: Controller,
) -> Creep:
    """Bound the creep of one controller, at the worst gains of its ranges.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With the sensor and the processor.
    loop : MotionLoop
        The motion loop in use.
    given : AbstractControllerSpec
        With the ranges of its gains.
    controller : Controller
        With the gains that ship.
    """
    gains, sensor = controller.law.gains, build_sensor(spec.sensor)
    ranges = {name: gain_interval(gain, gains[name]) for name, gain in given.gains().items()}
    lowest = {name: interval.low for name, interval in ranges.items()}
    followed = abs(loop.numerator[-1] / loop.denominator[-1])
    error, noise = sensor.lasting * followed, _noise(sensor, gains)
    sampling = spec.sampling
    gain = 1 / lowest["Bt"]
    if sampling is not None:
        period = sampling.outer
        error = sensor.lasting
        if sensor.filter is not None:
            error *= sensor.filter.discretize(period).lasting_gain
        law = controller.law.discretize(period, sampling.admittance)
        assert law is not None
        retuned = controller.law.enclose(ranges, period, sampling.admittance)
        lasting = retuned["c"].high if "c" in retuned else lasting_gain(law.numbers)
        gain = lasting * law.numbers["T"] / period
    if "Kt" in lowest:
        return Creep(Fraction(0), error / lowest["Kt"], noise)
    return Creep(error * gain, None, noise)


def with_creep(achieved: tuple[Achieved, ...], creep: Creep) -> tuple[Achieved, ...]:
    """Put the exact bounds, rounded up, in the place of what the search has used for them.

    Parameters
    ----------
    achieved : tuple of Achieved
        Of one controller.
    creep : Creep
        Its bounds.
    """
    angle = math.inf if creep.angle is None else upper_float(creep.angle)
    exact = {CREEP: upper_float(creep.velocity), CREEP_ANGLE: angle}
    return tuple(
        replace(item, value=exact[item.measure]) if item.measure in exact else item
        for item in achieved
    )


def _noise(sensor: Sensor, gains: Mapping[str, Fraction]) -> float | None:
    """Return the standard deviation of the velocity that an admittance makes of white noise."""
    if sensor.noise is None:
        return None
    Mt, Bt, Kt = (float(gains.get(name, 0)) for name in ("Mt", "Bt", "Kt"))
    above, below = ((1.0, 0.0), (Mt, Bt, Kt)) if Kt else ((1.0,), (Mt, Bt))
    lags = (1.0,) if sensor.filter is None else sensor.filter.denominator
    power = white_noise_power(above, np.convolve(trim(below), lags).tolist())
    return None if power is None else math.sqrt(sensor.noise * power)
