"""What is fitted: a first-order velocity model with Coulomb friction (thesis 4.1)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.statistics import Estimate, Uncertainty, student_quantile
from nrs_design.models.actuator import (
    Actuator,
    MotorConstants,
    armature_resistance,
    speed_torque_gradient,
)

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True, slots=True)
class MotorFigures:
    """What follows from the fit and the data sheet.

    Parameters
    ----------
    resistance : Estimate
        Armature resistance R in ohm (thesis 4.6).
    gradient : Estimate
        Speed over torque in rpm/(N m) (thesis 4.10).
    """

    resistance: Estimate
    gradient: Estimate


@dataclass(frozen=True, slots=True, eq=False)
class ActuatorFit:
    """``tau v' + v = gain (delta - friction sign v)``.

    Parameters
    ----------
    method : str
        How it was found.
    gain : Estimate
        In (rad/s)/rpm.
    time_constant : Estimate
        In s.
    friction : Estimate or None
        Coulomb friction in rpm of the command; None where the data cannot tell.
    uncertainty : Uncertainty
        Of the logarithms of these, in this order.
    """

    method: str
    gain: Estimate
    time_constant: Estimate
    friction: Estimate | None
    uncertainty: Uncertainty

    def response(self, frequency: Array) -> Complex:
        """Return velocity over command without friction, in (rad/s)/rpm, at rad/s."""
        return np.asarray(self.gain.value / (1 + 1j * frequency * self.time_constant.value))

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
        return MotorFigures(estimate, estimate.scaled(speed_torque_gradient(1.0, motor)))


def actuator_fit(method: str, logarithms: Array, known: Uncertainty) -> ActuatorFit:
    """Return a fit from the logarithms of gain, time constant and, if there, friction.

    Parameters
    ----------
    method : str
        How it was found.
    logarithms : ndarray
        Of gain, time constant and, if there, friction.
    known : Uncertainty
        Of the logarithms.
    """
    estimates = known.estimates(logarithms)
    friction = estimates[2] if len(estimates) > 2 else None
    return ActuatorFit(method, estimates[0], estimates[1], friction, known)
