"""Kinds of quantities in a spec, with the known confusions of each."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

from nrs_design.models.axis import COMMAND_UNITS, AxisType
from nrs_design.spec.quantity import QuantityKind, written_as

_TABLE = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
_ON_A_SLIDE = "the axis is prismatic: "


def _kind(key: str) -> QuantityKind:
    """Return a kind of the table, and the corresponding kind on a sliding axis."""
    row = _TABLE[key]
    name, units, example = row["kind"]
    filled = (unit.format(command) for unit in units.split() for command in COMMAND_UNITS)
    each = tuple(dict.fromkeys(filled))
    confusions, rational = row.get("confusions", {}), row.get("rational", True)
    kind = QuantityKind(name, each, example, confusions, rational=rational)
    if "slides" not in row:
        return kind
    name, example = row["slides"]
    turned = tuple(map(AxisType.PRISMATIC.unit, each if kind.is_about_commands else each[:1]))
    return replace(kind, sliding=QuantityKind(name, turned, example, reason=_ON_A_SLIDE))


ACTUATOR_GAIN = _kind("ACTUATOR_GAIN")
DURATION = _kind("DURATION")
DWELL_TIME = _kind("DWELL_TIME")
DERIVATIVE_GAIN = _kind("DERIVATIVE_GAIN")
ZERO = _kind("ZERO")
DECAY = _kind("DECAY")
ANGULAR_VELOCITY = _kind("ANGULAR_VELOCITY")
TORQUE = _kind("TORQUE")
INITIAL_TORQUE = replace(TORQUE, example="0.5 N*m")
BANDWIDTH = _kind("BANDWIDTH")
STIFFNESS = _kind("STIFFNESS")
DAMPING = _kind("DAMPING")
HAND_MASS = _kind("HAND_MASS")
LEVER_ARM = _kind("LEVER_ARM")
IMPEDANCE = _kind("IMPEDANCE")
INERTIA = _kind("INERTIA")
FORCE_GAIN = _kind("FORCE_GAIN")
INTEGRAL_FORCE_GAIN = _kind("INTEGRAL_FORCE_GAIN")
SPRING = _kind("SPRING")
TORQUE_RATE = _kind("TORQUE_RATE")
LINEAR_STIFFNESS = _kind("LINEAR_STIFFNESS")
LINEAR_DAMPING = _kind("LINEAR_DAMPING")
MASS = _kind("MASS")
LENGTH = _kind("LENGTH")
ANGLE = _kind("ANGLE")
PHASE = _kind("PHASE")
DEFLECTION = QuantityKind(
    "a deflection",
    ("m", "rad"),
    "5 mm",
    {"N": "that is a force: write the deflection in mm, or in rad at the pivot"},
    rational=False,
    sliding=QuantityKind("a deflection", ("m",), "5 mm", reason=_ON_A_SLIDE),
)
LINEAR_VELOCITY = _kind("LINEAR_VELOCITY")
ACCELERATION = _kind("ACCELERATION")
ANGULAR_ACCELERATION = _kind("ANGULAR_ACCELERATION")
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
# Commands of any drive: a motor, or an interface to velocities or positions.
DRIVE_COMMAND = _kind("DRIVE_COMMAND")
TORQUE_GRADIENT = _kind("TORQUE_GRADIENT")
