"""What is fitted: a velocity model with Coulomb friction (thesis 4.1) and dead time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from nrs_design.identification.actuator.motor import MotorModel
from nrs_design.identification.actuator.time_fit import TimeFit
from nrs_design.identification.numeric import Array, Complex
from nrs_design.identification.statistics import (
    Estimate,
    Uncertainty,
    joint_level,
    student_quantile,
)
from nrs_design.models.actuator import (
    Actuator,
    MotorConstants,
    armature_resistance,
    speed_torque_gradient,
)

# A log does not say when within a sample a command began.
FROM_THE_ROW = (
    "counted from the row that first holds a command; one that began before it, by up to a sample, "
    "is later by as much"
)


@dataclass(frozen=True, slots=True)
class MotorFigures:
    """What follows from the fit and the data sheet."""

    resistance: Estimate  # Armature resistance R in ohm (thesis 4.6)
    gradient: Estimate  # Speed over torque in rpm/(N m) (thesis 4.10)
    motor: MotorConstants  # The data sheet

    @property
    def sheet(self) -> str:
        """The data sheet in words: these figures are about no other motor."""
        motor = self.motor
        return (
            f"K_T = {motor.torque_constant:g} N m/A, K_B = {motor.back_emf_constant:g} V s/rad, "
            f"inertia {motor.inertia:g} kg m^2, reduction {motor.reduction:g}"
        )


@dataclass(frozen=True, slots=True, eq=False)
class ActuatorFit:
    """``tau v' + v = gain (delta(t - D) - friction sign v)``."""

    method: str  # How it was found
    gain: Estimate  # In rad/s for each unit of the command
    time_constant: Estimate  # In s; of a motor of second order the sum of both
    # Coulomb friction in units of the command; None where the data cannot tell.
    friction: Estimate | None
    uncertainty: Uncertainty  # Of the logarithms of these, in this order
    dead_time: Estimate | None = None  # D in s; None where it was taken for zero
    # What was fitted in time; None for a fit in the frequency domain.
    motor: MotorModel | None = None

    @property
    def order(self) -> int:
        """1, or 2 for a motor with two time constants."""
        return 1 if self.motor is None or self.motor.damping is None else 2

    @property
    def ranges(self) -> tuple[Estimate, Estimate]:
        """Gain and time constant between ends that hold with 95 % for both together."""
        logarithms = np.log([self.gain.value, self.time_constant.value])
        known = replace(self.uncertainty, covariance=self.uncertainty.covariance[:2, :2])
        gain, time_constant = known.estimates(logarithms, joint_level(2))
        return gain, time_constant

    def response(self, frequency: Array) -> Complex:
        """Return velocity over command without friction, in rad/s per unit, at rad/s."""
        s = 1j * frequency
        if self.motor is None:
            return np.asarray(self.gain.value / (1 + s * self.time_constant.value))
        lags = self.motor.lags
        value = sum(c / (1 + s * t) for t, c in zip(lags.times, lags.shares, strict=True))
        return np.asarray(self.motor.gain * value * np.exp(-s * self.motor.delay))

    def figures(self, motor: MotorConstants) -> MotorFigures:
        """Derive resistance and speed-torque gradient, with intervals.

        Both are proportional to ``time_constant / gain``.
        """
        actuator = Actuator(Fraction(self.gain.value), Fraction(self.time_constant.value))
        resistance = armature_resistance(actuator, motor)
        contrast = np.zeros(len(self.uncertainty.covariance))
        contrast[:2] = -1.0, 1.0
        variance = float(contrast @ self.uncertainty.covariance @ contrast)
        half = student_quantile(self.uncertainty.degrees) * float(np.sqrt(variance))
        estimate = Estimate.from_log(float(np.log(resistance)), half)
        gradient = estimate.scaled(speed_torque_gradient(1.0, motor))
        return MotorFigures(estimate, gradient, motor)


def actuator_fit(method: str, logarithms: Array, known: Uncertainty) -> ActuatorFit:
    """Return a fit from logarithms of gain, time constant and, if any, friction."""
    estimates = known.estimates(logarithms)
    friction = estimates[2] if len(estimates) > 2 else None
    return ActuatorFit(method, estimates[0], estimates[1], friction, known)


def fit_of(method: str, found: TimeFit, longest: float) -> ActuatorFit:
    """Return the estimates of a fit in time; a dead time is never below zero.

    One that may be beyond the longest, in s, is not determined.
    """
    motor, known = found.motor, found.uncertainty
    gain, time_constant, *others = known.estimates(motor.parameters)[:-1]
    half = student_quantile(known.degrees) * float(known.errors[-1])
    ends = (motor.delay, motor.delay - half, motor.delay + half)
    late = Estimate(*(max(end, 0.0) for end in ends)) if ends[-1] <= longest else None
    friction = None if motor.friction is None else others[0]
    return ActuatorFit(method, gain, time_constant, friction, known, late, motor)
