"""Choose the gains of the robot's motion controllers (thesis 4.2 to 4.4)."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.design.root_locus import PdDesign, design_pd
from nrs_design.errors import DesignError
from nrs_design.robot.controllers.motion_laws import ComputedTorque, IndependentJoint, LoadModel
from nrs_design.robot.models.correction import DEPTH_SINES, correction_coefficients
from nrs_design.robot.models.drive import build_drive
from nrs_design.robot.models.robot import Robot
from nrs_design.spec import RobotControlSpec, RobotSpec


def control_of(spec: RobotSpec) -> RobotControlSpec:
    """Return what a robot spec says about its motion control; nothing said is a `DesignError`."""
    if spec.control is None:
        raise DesignError("this robot spec has no `control`", remedy="add it, as `init robot` does")
    if spec.control.motion_loop.transfer_function is not None:
        raise DesignError(
            "motion control needs a controller, not a closed loop",
            remedy="take transfer_function out of control.motion_loop",
        )
    return spec.control


def design_load_model(spec: RobotSpec, robot: Robot) -> LoadModel:
    """Return the simplified dynamics with the correction coefficients for the robot's tilt.

    These are mean ratios over slow motions of the depth, as thesis 4.19 takes them from fig. 3.12.
    """
    first, second, third = correction_coefficients(robot, DEPTH_SINES).mean_ratio.tolist()
    return LoadModel(robot, build_drive(spec.drive).encoder_ratio, (first, second, third))


def design_computed_torque(spec: RobotSpec, load: LoadModel) -> ComputedTorque:
    """Choose the error dynamics by damping ratio and settling time (thesis 4.14 and 4.15)."""
    control, drive = control_of(spec), build_drive(spec.drive)
    wn = _root_locus(spec).natural_frequency
    return ComputedTorque(
        Kp=wn**2,
        Kd=2 * float(control.motion_loop.damping_ratio) * wn,
        period=control.sample_period.si,
        encoder_ratio=drive.encoder_ratio,
        command_per_torque=1 / drive.torque_per_command,
        load=load,
    )


def design_independent_joint(spec: RobotSpec, load: LoadModel | None) -> IndependentJoint:
    """Choose the PD by root locus, or take the one that the spec gives (thesis 4.30)."""
    control, drive = control_of(spec), build_drive(spec.drive)
    return IndependentJoint(
        motion=_proportional_derivative(spec),
        period=control.sample_period.si,
        encoder_ratio=drive.encoder_ratio,
        command_per_torque=1 / drive.torque_per_command,
        load=load,
    )


def _proportional_derivative(spec: RobotSpec) -> ProportionalDerivative:
    given, wanted = control_of(spec).motion_loop, _root_locus(spec)
    Kd = to_float32(
        Fraction(wanted.derivative_gain)
        if given.derivative_gain is None
        else given.derivative_gain.exact
    )
    zero = Fraction(wanted.zero) if given.zero is None else given.zero.exact
    return ProportionalDerivative(Kp=to_float32(Kd * zero), Kd=Kd)


def _root_locus(spec: RobotSpec) -> PdDesign:
    loop = control_of(spec).motion_loop
    return design_pd(
        spec.drive.gain.si,
        spec.drive.time_constant.si,
        float(loop.damping_ratio),
        loop.settling_time.si,
    )
