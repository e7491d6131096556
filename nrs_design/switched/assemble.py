"""From a spec (and the designed gains) to the exact switched system that it describes."""

from __future__ import annotations

from collections.abc import Mapping

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.gains import design_from_gains
from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.errors import AssemblyError
from nrs_design.models.actuator import Actuator
from nrs_design.models.motion_loop import MotionLoop, close_motion_loop
from nrs_design.models.plant import build_plant
from nrs_design.spec import InteractionDesignSpec, RobotSpec, Spec, SwitchedSystemSpec
from nrs_design.switched.close_loop import close_loop
from nrs_design.switched.matrix import RationalMatrix
from nrs_design.switched.system import Mode, SwitchedSystem, Time

GIVEN_MATRICES = (
    "The modes are the matrices of the spec, taken exactly; the input is zero.",
    "The state is continuous at a switch (identity resets); any switching signal is possible.",
)


def assemble(
    spec: Spec, gains: Mapping[str, Mapping[str, str]], coordinates: str | None
) -> SwitchedSystem:
    """Assemble the switched system of a spec from its text and the designed gains.

    Parameters
    ----------
    spec : Spec
        Either kind.
    gains : mapping
        As `nrs_design.controllers.gains.gains_of` gives them; empty for given matrices.
    coordinates : {"deflection", "force"} or None
        None for given matrices.

    Raises
    ------
    AssemblyError, CertificateError
        If gains or coordinates do not fit the spec.
    """
    if isinstance(spec, SwitchedSystemSpec):
        if gains or coordinates is not None:
            raise AssemblyError("given matrices have neither gains nor coordinates")
        return from_matrices(spec)
    if isinstance(spec, RobotSpec):
        raise AssemblyError("a robot spec has no modes")
    return from_design(spec, design_from_gains(spec, gains), coordinates)


def from_matrices(spec: SwitchedSystemSpec) -> SwitchedSystem:
    """Return the system of a `switched-system` spec."""
    modes = tuple(Mode(mode.name, RationalMatrix.from_rows(mode.A)) for mode in spec.modes)
    states = tuple(f"x{i + 1}" for i in range(len(spec.modes[0].A)))
    return SwitchedSystem(spec.name, Time(spec.time), states, modes, GIVEN_MATRICES)


def from_design(
    spec: InteractionDesignSpec, design: ControllerDesign, coordinates: str | None
) -> SwitchedSystem:
    """Return the closed loop of an interaction design."""
    if coordinates not in ("deflection", "force"):
        raise AssemblyError(f"unknown coordinates {coordinates!r}: deflection or force")
    loop = motion_loop(spec, design.motion)
    return close_loop(spec.name, build_plant(spec), loop, design, coordinates)


def motion_loop(spec: InteractionDesignSpec, motion: ProportionalDerivative) -> MotionLoop:
    """Return G: the one that the spec gives, else the one that actuator and PD make."""
    given = spec.motion_loop.transfer_function
    if given is not None:
        return MotionLoop(given.numerator, given.denominator, given=True)
    actuator = Actuator(spec.actuator.gain.exact, spec.actuator.time_constant.exact)
    return close_motion_loop(actuator, motion.Kp, motion.Kd)
