"""The kinds of quantities that a spec holds, with the confusions that are known for each."""

from __future__ import annotations

from dataclasses import replace

from nrs_design.axis import COMMAND_UNITS
from nrs_design.spec.quantity import QuantityKind, written_as

_FREQUENCY = "{value} 1/s names no angle: write '{value} Hz' or '{value} rad/s'"
_GAINS = tuple(f"rad/s/{command}" for command in COMMAND_UNITS)


def _sliding(name: str, units: tuple[str, ...], example: str) -> QuantityKind:
    """Return a kind of quantity of an axis that slides."""
    return QuantityKind(name, units, example, reason="the axis is prismatic: ")


ACTUATOR_GAIN = QuantityKind(
    "an actuator gain",
    _GAINS,
    "4.8417e-4 rad/s/rpm",
    {
        "rpm/V": "rpm is the driver's command unit and is never converted: write rad/s/V (1 rpm is "
        "pi/30 rad/s)"
    },
    sliding=_sliding(
        "an actuator gain", tuple(f"m/s/{c}" for c in COMMAND_UNITS), "1.2e-4 m/s/rpm"
    ),
)
DURATION = QuantityKind("a duration", ("s",), "0.0351 s")
DWELL_TIME = QuantityKind("a dwell time", ("s",), "2.76 s")
DERIVATIVE_GAIN = QuantityKind(
    "a derivative gain",
    tuple(f"{command}*s/rad" for command in COMMAND_UNITS),
    "2060 rpm*s/rad",
    sliding=_sliding("a derivative gain", tuple(f"{c}*s/m" for c in COMMAND_UNITS), "8600 rpm*s/m"),
)
ZERO = QuantityKind("a zero of the PD controller", ("1/s",), "56.9706 1/s")
DECAY = QuantityKind("a rate of decay", ("1/s",), "20 1/s")
ANGULAR_VELOCITY = QuantityKind(
    "an angular velocity",
    ("rad/s", "deg/s"),
    "8 deg/s",
    {"rpm": "rpm is the driver's command unit and is never converted: write deg/s or rad/s"},
    rational=False,
    sliding=_sliding("a velocity", ("m/s",), "30 mm/s"),
)
TORQUE = QuantityKind(
    "a torque",
    ("N*m",),
    "0.3 N*m",
    {"N": "that is a force: multiply it by its lever arm and write N*m"},
    sliding=_sliding("a force", ("N",), "3 N"),
)
INITIAL_TORQUE = replace(TORQUE, example="0.5 N*m")
BANDWIDTH = QuantityKind(
    "a bandwidth",
    ("rad/s", "Hz"),
    "2 Hz",
    {
        "1/s": _FREQUENCY,
        "rpm": "rpm is the driver's command unit and is never converted: write Hz or rad/s",
    },
    rational=False,
)
STIFFNESS = QuantityKind(
    "a stiffness",
    ("N*m/rad", "N/m"),
    "43.0356 N*m/rad",
    sliding=_sliding("a stiffness", ("N/m",), "747.1461 N/m"),
)
DAMPING = QuantityKind(
    "a damping",
    ("N*m*s/rad", "N*m*s", "N*s/m"),
    "0.5 N*m*s/rad",
    sliding=_sliding("a damping", ("N*s/m",), "5 N*s/m"),
)
HAND_MASS = QuantityKind(
    "a mass that moves with the contact",
    ("kg*m^2", "kg*m^2/rad", "kg"),
    "0.1 kg*m^2",
    {"N": "that is a weight: divide it by the gravity and write kg"},
    sliding=_sliding("a mass that moves with the contact", ("kg",), "1.7 kg"),
)
LEVER_ARM = QuantityKind("a length", ("m",), "240 mm")
IMPEDANCE = QuantityKind(
    "an impedance",
    ("N*m*s/rad", "kg*m^2/s"),
    "2.15 N*m*s/rad",
    {
        "N*s/m": "that is a linear damping: multiply it by the square of its lever arm and write "
        "N*m*s/rad"
    },
    sliding=_sliding("an impedance", ("N*s/m",), "37 N*s/m"),
)
INERTIA = QuantityKind(
    "an inertia",
    ("kg*m^2", "kg*m^2/rad"),
    "0.01 kg*m^2",
    {"kg": "that is a mass: multiply it by the square of its lever arm and write kg*m^2"},
    sliding=_sliding("a mass", ("kg",), "1.7 kg"),
)
FORCE_GAIN = QuantityKind(
    "a proportional force gain",
    ("rad/(N*m)",),
    "0.02 rad/(N*m)",
    {"rad*m/N": "rad/N*m is (rad/N)*m: write '{value} rad/(N*m)'"},
    sliding=_sliding("a proportional force gain", ("m/N",), "3e-4 m/N"),
)
INTEGRAL_FORCE_GAIN = QuantityKind(
    "an integral force gain",
    ("rad/(N*m*s)",),
    "0.5 rad/(N*m*s)",
    sliding=_sliding("an integral force gain", ("m/(N*s)",), "8e-3 m/(N*s)"),
)

SPRING = QuantityKind(
    "a rotational stiffness",
    ("N*m/rad",),
    "0.5 N*m/rad",
    {
        "N/m": "that is a linear stiffness: multiply it by the square of its lever arm and write "
        "N*m/rad"
    },
    sliding=_sliding("a stiffness", ("N/m",), "9 N/m"),
)
TORQUE_RATE = QuantityKind(
    "a rate of torque",
    ("N*m/s",),
    "1e-5 N*m/s",
    sliding=_sliding("a rate of force", ("N/s",), "1e-5 N/s"),
)
LINEAR_STIFFNESS = QuantityKind("a linear stiffness", ("N/m",), "747.1461 N/m")
LINEAR_DAMPING = QuantityKind("a linear damping", ("N*s/m",), "5 N*s/m")

MASS = QuantityKind(
    "a mass", ("kg",), "73.3 g", {"N": "that is a weight: divide it by the gravity and write g"}
)
FORCE = QuantityKind("a force", ("N",), "1.3 N")
LENGTH = QuantityKind("a length", ("m",), "135 mm")
ANGLE = QuantityKind(
    "an angle", ("rad",), "45 deg", rational=False, sliding=_sliding("a position", ("m",), "20 mm")
)
PHASE = QuantityKind("a phase", ("rad",), "30 deg", rational=False)
DEFLECTION = QuantityKind(
    "a deflection",
    ("m", "rad"),
    "5 mm",
    {"N": "that is a force: write the deflection in mm, or in rad at the pivot"},
    rational=False,
    sliding=_sliding("a deflection", ("m",), "5 mm"),
)
LINEAR_VELOCITY = QuantityKind("a velocity", ("m/s",), "18.5 mm/s")
ACCELERATION = QuantityKind("an acceleration", ("m/s^2",), "9.81 m/s^2")
ANGULAR_ACCELERATION = QuantityKind(
    "an angular acceleration",
    ("rad/s^2",),
    "3.584 rad/s^2",
    rational=False,
    sliding=_sliding("an acceleration", ("m/s^2",), "2 m/s^2"),
)
_DRIVERS_OWN = (
    "the driver's command has a unit of its own that is never converted: write "
    f"{written_as(COMMAND_UNITS)}; a robot that follows a streamed velocity or position has none: "
    "leave it out"
)
COMMAND = QuantityKind(
    "a command of the motor",
    (*COMMAND_UNITS, "N*m"),
    "276.575 rpm",
    dict.fromkeys(("rad/s", "rad"), _DRIVERS_OWN),
    sliding=QuantityKind(
        "a command of the motor",
        (*COMMAND_UNITS, "N"),
        "276.575 rpm",
        dict.fromkeys(("m/s", "m"), _DRIVERS_OWN),
    ),
)
# What any drive takes: a motor, or an interface to velocities or positions.
DRIVE_COMMAND = QuantityKind(
    "a command of the drive",
    (*COMMAND_UNITS, "N*m", "rad/s", "rad"),
    "276.575 rpm",
    sliding=QuantityKind(
        "a command of the drive", (*COMMAND_UNITS, "N", "m/s", "m"), "276.575 rpm"
    ),
)
TORQUE_GRADIENT = QuantityKind(
    "a speed-torque gradient",
    ("rpm/(N*m)",),
    "2.7044e5 rpm/(N*m)",
    {"rpm*m/N": "rpm/N*m is (rpm/N)*m: write '{value} rpm/(N*m)'"},
)
