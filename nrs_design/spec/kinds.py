"""The kinds of quantities that a spec holds, with the confusions that are known for each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from nrs_design.axis import COMMAND_UNITS, AxisType
from nrs_design.spec.quantity import QuantityKind, written_as

_ON_A_SLIDE = "the axis is prismatic: "
_FREQUENCY = "{value} 1/s names no angle: write '{value} Hz' or '{value} rad/s'"
_RPM = "rpm is the driver's command unit and is never converted: write "
_ARM = "multiply it by its lever arm and write "
_ARM_SQUARED = "multiply it by the square of its lever arm and write "


def _kind(
    name: str,
    units: str,
    example: str,
    confusions: Mapping[str, str] | None = None,
    *,
    rational: bool = True,
    slides: tuple[str, str] | None = None,
) -> QuantityKind:
    """Return a kind; `slides` has its name and an example on an axis that slides.

    Units have spaces between; ``{}`` stands for each unit of commands.
    """
    each = tuple(
        filled
        for unit in units.split()
        for filled in dict.fromkeys(unit.format(command) for command in COMMAND_UNITS)
    )
    kind = QuantityKind(name, each, example, confusions or {}, rational=rational)
    if slides is None:
        return kind
    turned = tuple(map(AxisType.PRISMATIC.unit, each if kind.is_about_commands else each[:1]))
    return replace(kind, sliding=QuantityKind(slides[0], turned, slides[1], reason=_ON_A_SLIDE))


ACTUATOR_GAIN = _kind(
    "an actuator gain",
    "rad/s/{}",
    "4.8417e-4 rad/s/rpm",
    {"rpm/V": f"{_RPM}rad/s/V (1 rpm is pi/30 rad/s)"},
    slides=("an actuator gain", "1.2e-4 m/s/rpm"),
)
DURATION = _kind("a duration", "s", "0.0351 s")
DWELL_TIME = _kind("a dwell time", "s", "2.76 s")
DERIVATIVE_GAIN = _kind(
    "a derivative gain",
    "{}*s/rad",
    "2060 rpm*s/rad",
    slides=("a derivative gain", "8600 rpm*s/m"),
)
ZERO = _kind("a zero of the PD controller", "1/s", "56.9706 1/s")
DECAY = _kind("a rate of decay", "1/s", "20 1/s")
ANGULAR_VELOCITY = _kind(
    "an angular velocity",
    "rad/s deg/s",
    "8 deg/s",
    {"rpm": f"{_RPM}deg/s or rad/s"},
    rational=False,
    slides=("a velocity", "30 mm/s"),
)
TORQUE = _kind(
    "a torque", "N*m", "0.3 N*m", {"N": f"that is a force: {_ARM}N*m"}, slides=("a force", "3 N")
)
INITIAL_TORQUE = replace(TORQUE, example="0.5 N*m")
BANDWIDTH = _kind(
    "a bandwidth",
    "rad/s Hz",
    "2 Hz",
    {"1/s": _FREQUENCY, "rpm": f"{_RPM}Hz or rad/s"},
    rational=False,
)
STIFFNESS = _kind(
    "a stiffness", "N*m/rad N/m", "43.0356 N*m/rad", slides=("a stiffness", "747.1461 N/m")
)
DAMPING = _kind(
    "a damping", "N*m*s/rad N*m*s N*s/m", "0.5 N*m*s/rad", slides=("a damping", "5 N*s/m")
)
HAND_MASS = _kind(
    "a mass that moves with the contact",
    "kg*m^2 kg*m^2/rad kg",
    "0.1 kg*m^2",
    {"N": "that is a weight: divide it by the gravity and write kg"},
    slides=("a mass that moves with the contact", "1.7 kg"),
)
LEVER_ARM = _kind("a length", "m", "240 mm")
IMPEDANCE = _kind(
    "an impedance",
    "N*m*s/rad kg*m^2/s",
    "2.15 N*m*s/rad",
    {"N*s/m": f"that is a linear damping: {_ARM_SQUARED}N*m*s/rad"},
    slides=("an impedance", "37 N*s/m"),
)
INERTIA = _kind(
    "an inertia",
    "kg*m^2 kg*m^2/rad",
    "0.01 kg*m^2",
    {"kg": f"that is a mass: {_ARM_SQUARED}kg*m^2"},
    slides=("a mass", "1.7 kg"),
)
FORCE_GAIN = _kind(
    "a proportional force gain",
    "rad/(N*m)",
    "0.02 rad/(N*m)",
    {"rad*m/N": "rad/N*m is (rad/N)*m: write '{value} rad/(N*m)'"},
    slides=("a proportional force gain", "3e-4 m/N"),
)
INTEGRAL_FORCE_GAIN = _kind(
    "an integral force gain",
    "rad/(N*m*s)",
    "0.5 rad/(N*m*s)",
    slides=("an integral force gain", "8e-3 m/(N*s)"),
)
SPRING = _kind(
    "a rotational stiffness",
    "N*m/rad",
    "0.5 N*m/rad",
    {"N/m": f"that is a linear stiffness: {_ARM_SQUARED}N*m/rad"},
    slides=("a stiffness", "9 N/m"),
)
TORQUE_RATE = _kind(
    "a rate of torque", "N*m/s", "1e-5 N*m/s", slides=("a rate of force", "1e-5 N/s")
)
LINEAR_STIFFNESS = _kind("a linear stiffness", "N/m", "747.1461 N/m")
LINEAR_DAMPING = _kind("a linear damping", "N*s/m", "5 N*s/m")
MASS = _kind(
    "a mass", "kg", "73.3 g", {"N": "that is a weight: divide it by the gravity and write g"}
)
LENGTH = _kind("a length", "m", "135 mm")
ANGLE = _kind("an angle", "rad", "45 deg", rational=False, slides=("a position", "20 mm"))
PHASE = _kind("a phase", "rad", "30 deg", rational=False)
DEFLECTION = QuantityKind(
    "a deflection",
    ("m", "rad"),
    "5 mm",
    {"N": "that is a force: write the deflection in mm, or in rad at the pivot"},
    rational=False,
    sliding=QuantityKind("a deflection", ("m",), "5 mm", reason=_ON_A_SLIDE),
)
LINEAR_VELOCITY = _kind("a velocity", "m/s", "18.5 mm/s")
ACCELERATION = _kind("an acceleration", "m/s^2", "9.81 m/s^2")
ANGULAR_ACCELERATION = _kind(
    "an angular acceleration",
    "rad/s^2",
    "3.584 rad/s^2",
    rational=False,
    slides=("an acceleration", "2 m/s^2"),
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
DRIVE_COMMAND = _kind(
    "a command of the drive",
    "{} N*m rad/s rad",
    "276.575 rpm",
    slides=("a command of the drive", "276.575 rpm"),
)
TORQUE_GRADIENT = _kind(
    "a speed-torque gradient",
    "rpm/(N*m)",
    "2.7044e5 rpm/(N*m)",
    {"rpm*m/N": "rpm/N*m is (rpm/N)*m: write '{value} rpm/(N*m)'"},
)
