"""The admittance of three axes in one step: from contact torques to velocities, no motor loop.

All axes have the gains of one mode. What moves by the velocities is left to the caller.
"""

from __future__ import annotations

from fractions import Fraction

from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.controllers.parts import BEYOND
from nrs_design.controllers.step_analysis import check_range

AXES = (1, 2, 3)
# What a law has beside an admittance with inertia, by its coefficients.
_OTHERS = {
    "Kf": "force control",
    "Kt": "a spring of impedance control",
    "p": "a filter of the force",
}


def lacks_axes(law: StepLaw) -> str:
    """Return why the admittance of a law is not written for three axes; empty if it is."""
    held = law.coefficient
    if "a" not in held:
        return (
            "no controller has a virtual inertia, so there is no step from one velocity to the next"
        )
    found = [what for name, what in _OTHERS.items() if name in held]
    return f"the step of three axes has no {found[0]}" if found else ""


def build_axes_law(law: StepLaw) -> StepLaw:
    """Return the step of three axes with the admittances of one.

    Parameters
    ----------
    law : StepLaw
        Impedance control of one axis, of which `lacks_axes` says nothing.
    """
    kept = tuple(law.coefficient[name] for name in ("a", "b"))
    return axes_law(law.modes, kept)


def axes_law(modes: tuple[str, ...], coefficients: tuple[Coefficient, ...]) -> StepLaw:
    """Return ``v+ = a v + b F`` of three axes.

    Parameters
    ----------
    modes : tuple of str
        Between which the robot switches.
    coefficients : tuple of Coefficient
        a and b, one for each mode.
    """
    made = StepLaw(
        modes,
        tuple(_value("torque", i, "F", "N*m", "measured torque of the contact") for i in AXES),
        tuple(_value("velocity", i, "vm", "rad/s", "velocity of the admittance") for i in AXES),
        coefficients,
        tuple(operation for i in AXES for operation in _admitted(i)),
        {f"moves_{i}": f"next_velocity_{i}" for i in AXES},
        {f"velocity_{i}": f"next_velocity_{i}" for i in AXES},
        {f"moves_{i}": "rad/s" for i in AXES},
    )
    check_range(made)
    return made


def _value(name: str, axis: int, symbol: str, unit: str, meaning: str) -> Value:
    limit: Fraction = BEYOND
    return Value(f"{name}_{axis}", f"{symbol}{axis}", unit, limit, f"{meaning} of axis {axis}")


def _admitted(axis: int) -> tuple[Operation, ...]:
    return (
        Operation(f"kept_{axis}", "multiply", "a", f"velocity_{axis}"),
        Operation(f"pushed_{axis}", "multiply", "b", f"torque_{axis}"),
        Operation(f"next_velocity_{axis}", "add", f"kept_{axis}", f"pushed_{axis}"),
    )
