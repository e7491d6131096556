"""Choose the gains of a PI force controller, and analyze it.

With ``z = Ki/Kp`` the force loop is ``Kp k M`` with ``M = (s + z)/s G``: that of a proportional
controller (thesis 6.33) on another motion loop.
"""

from __future__ import annotations

import numpy as np

from nrs_design.controllers.controller_design import Controller
from nrs_design.controllers.float32 import round_float32, round_significant
from nrs_design.controllers.laws.pi_force import IntegralForce
from nrs_design.design.force_loop import Approach, force_loop_response
from nrs_design.design.laws.force import ForceAnalysis, analyze_approach, proportional_gain
from nrs_design.design.laws.law import Choice, LawDesign, Task
from nrs_design.design.measures import MARGINS
from nrs_design.design.transfer import TransferFunction
from nrs_design.errors import DesignError
from nrs_design.spec.controllers import IntegralControllerSpec

_SETTLED = 4.0  # Time constants until 2 % are left, as in thesis 4.14
_POLE_TOLERANCE = 1e-6  # Largest relative rounding error of a pole


def add_integral(motion: TransferFunction, zero: float) -> TransferFunction:
    """Return ``(s + zero)/s G(s)``; the zero is ``Ki/Kp`` in 1/s."""
    numerator = np.polymul(motion.numerator, (1.0, zero))
    return TransferFunction(tuple(map(float, numerator)), (*motion.denominator, 0.0))


def integral_gain(
    motion: TransferFunction, stiffness: float, gain: float, settling_time: float
) -> float:
    """Return the Ki in rad/(N m s) that puts the slowest pole at ``p = -4/settling_time``.

    ``1 + k (Kp + Ki/p) G(p) = 0``, so ``Ki = -p (Kp + 1/(k G(p)))``, with k in N m/rad and the time
    in s. Where that pole would not be the slowest one, it is a `DesignError`.
    """
    pole = -_SETTLED / settling_time
    G = np.polyval(motion.numerator, pole) / np.polyval(motion.denominator, pole)
    Ki = float(-pole * (gain + 1 / (stiffness * G))) if G else 0.0
    if Ki > 0:
        response = force_loop_response(add_integral(motion, Ki / gain), stiffness, gain)
        if response.poles[0].real <= pole * (1 - _POLE_TOLERANCE):
            return Ki
    raise DesignError(
        f"no integral gain settles the force within {settling_time:.6g} s at this proportional "
        "gain: another pole is slower",
        remedy="give a longer settling_time, or the gains themselves",
        at=("settling_time",),
    )


def choose(task: Task, spec: IntegralControllerSpec) -> Choice:
    """Return the gains that the spec gives, or those with its damping ratio and settling time."""
    Kp = proportional_gain(task, spec)
    if spec.settling_time is None:
        assert spec.integral_gain is not None
        return IntegralForce(Kp, round_float32(spec.integral_gain.exact)), None
    if Kp == 0:
        raise DesignError(
            "the damping ratio asks for no proportional gain, and a PI controller has one",
            remedy="ask for another damping ratio, or give proportional_gain",
            at=("damping_ratio",),
        )
    gain = integral_gain(
        task.followed(spec), task.stiffness(spec), float(Kp), spec.settling_time.si
    )
    return IntegralForce(Kp, round_float32(round_significant(gain, task.digits))), None


def analyze(task: Task, given: IntegralControllerSpec, controller: Controller) -> ForceAnalysis:
    """Close the loop in nominal contact, which must be stable, and measure it in all contacts."""
    Kp, Ki = (float(controller.law.gains[name]) for name in ("Kp", "Ki"))
    limits = task.spec.limits
    # Position command and integral keep their values: the command does not step.
    approach = Approach("reference", limits.velocity.si, limits.torque.si, Ki)
    forward = add_integral(task.followed(given), Ki / Kp)
    return analyze_approach(task, given, controller, forward, approach, MARGINS)


DESIGN = LawDesign(choose, analyze)
