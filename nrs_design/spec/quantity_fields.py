"""Field types for quantities, bounds and ranges."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, WithJsonSchema
from pydantic_core import PydanticCustomError

from nrs_design.errors import SpecError
from nrs_design.proof.text import quoted
from nrs_design.spec import kinds
from nrs_design.spec.faults import as_text, fault, reported
from nrs_design.spec.model import ReadBy, SpecModel
from nrs_design.spec.quantity import (
    QUANTITY_PATTERN,
    Quantity,
    QuantityKind,
    checked_kind,
    parse_quantity,
)
from nrs_design.spec.range_checks import BOUND_CHECKS, RANGE_CHECKS


def read_quantity(
    value: object, kind: QuantityKind, *at: int | str, positive: bool, signed: bool = False
) -> Quantity:
    """Read a quantity of a kind from text, and check its sign unless it is ``signed``.

    Parameters
    ----------
    value : object
        As the document gives it.
    kind : QuantityKind
        What is measured.
    *at : int or str
        Where it stands, for faults.
    positive : bool
        Refuse zero too.
    signed : bool
        Allow negative ones.
    """

    def read() -> Quantity:
        if isinstance(value, Quantity):
            quantity = checked_kind(value, kind)
        else:
            quantity = parse_quantity(as_text(value, *at), kind)
        if not signed and (quantity.value < 0 or (positive and quantity.value == 0)):
            bound = "positive" if positive else "zero or positive"
            raise SpecError(
                f"{quoted(quantity.text)} must be {bound}",
                remedy="check the sign" if quantity.value else _above_zero(kind),
            )
        return quantity

    return reported(read, *at)


def _above_zero(kind: QuantityKind) -> str:
    such = "" if kind.is_about_commands else f", such as {kind.example!r}"
    return f"write a number above zero{such}"


def quantity_schema(kind: QuantityKind) -> dict[str, Any]:
    """JSON Schema of a quantity of this kind."""
    return {"type": "string", "pattern": QUANTITY_PATTERN, "examples": [kind.example]}


def _quantity(kind: QuantityKind, *, positive: bool = True, signed: bool = False) -> ReadBy:
    return ReadBy(lambda value: read_quantity(value, kind, positive=positive, signed=signed))


def _schema(kind: QuantityKind) -> WithJsonSchema:
    return WithJsonSchema(quantity_schema(kind))


# In the place of a quantity: as large as is found.
LARGEST = "largest"


def _read_or_largest(value: object, kind: QuantityKind) -> Quantity | str:
    """Read both in one place, so that what is neither is one fault."""
    if value == LARGEST:
        return LARGEST
    if isinstance(value, str) and not any(map(str.isdigit, value)):
        raise fault(
            f"{quoted(value)} is neither {kind.name} nor {LARGEST!r}",
            f"write {kind.example!r}, or {LARGEST!r}",
        )
    return read_quantity(value, kind, positive=True)


def _or_largest_schema(kind: QuantityKind) -> WithJsonSchema:
    return WithJsonSchema({"anyOf": [quantity_schema(kind), {"const": LARGEST}]})


def _as_is(value: object) -> Quantity:
    if isinstance(value, PydanticCustomError):
        raise value
    if not isinstance(value, Quantity):
        raise fault("expected a quantity", "write a number, a space and a unit")
    return value


# Inside bounds and ranges: the field around them knows the kind and reads the text.
AnyQuantity = Annotated[
    Quantity,
    ReadBy(_as_is),
    WithJsonSchema({"type": "string", "pattern": QUANTITY_PATTERN}),
]


class Bounds(SpecModel):
    """Closed interval."""

    min: AnyQuantity = Field(description="smallest admissible value")
    max: AnyQuantity = Field(description="largest admissible value")

    checks = BOUND_CHECKS

    @property
    def fixed(self) -> bool:
        """Whether only one value is admissible."""
        return self.min.rational_part == self.max.rational_part


class RangedQuantity(SpecModel):
    """Nominal value of an uncertain quantity, and the interval that it lies in.

    Without an interval in the spec, both ends are the nominal value.
    """

    nominal: AnyQuantity = Field(description="value that the design uses")
    range: tuple[AnyQuantity, AnyQuantity] = Field(
        default_factory=lambda data: (data.get("nominal"), data.get("nominal")),
        description="[lowest, highest] value that the proof covers; default: the nominal one",
    )

    checks = RANGE_CHECKS

    @property
    def fixed(self) -> bool:
        """Whether the range is a single value."""
        return self.range[0].rational_part == self.range[1].rational_part


def _bounds(kind: QuantityKind, *, positive: bool) -> BeforeValidator:
    def read(value: object) -> object:
        if isinstance(value, str | Quantity):
            quantity = read_quantity(value, kind, positive=positive)
            return {"min": quantity, "max": quantity}
        return read_entries(value, ("min", "max"), reader)

    def reader(value: object) -> Quantity:
        return read_quantity(value, kind, positive=positive)

    return BeforeValidator(read)


def _ranged(kind: QuantityKind, *, positive: bool, signed: bool = False) -> BeforeValidator:
    def read(value: object) -> object:
        if isinstance(value, str | Quantity):
            return {"nominal": reader(value)}
        entries = read_entries(value, ("nominal",), reader)
        if isinstance(entries, dict) and "range" in entries:
            entries["range"] = read_range(entries["range"], reader)
        return entries

    def reader(value: object) -> Quantity:
        return read_quantity(value, kind, positive=positive, signed=signed)

    return BeforeValidator(read)


Reader = Callable[[object], Quantity]
# A fault stands in for its quantity until the model reports it together with the others.
QuantityOrFault = Quantity | PydanticCustomError


def read_entries(value: object, keys: tuple[str, ...], reader: Reader) -> object:
    """Read the entries that are quantities; what else is wrong is left to the model.

    Parameters
    ----------
    value : object
        A mapping, as the document gives it.
    keys : tuple of str
        The entries that are read.
    reader : callable
        Reads one of them.
    """
    if not isinstance(value, dict):
        return value
    return value | {key: _read_or_fault(reader, value[key]) for key in value if key in keys}


def read_range(value: object, reader: Reader) -> tuple[QuantityOrFault, ...]:
    """Read both ends of a range."""
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise fault("expected two quantities", "write [lowest, highest]", "range")
    return tuple(_read_or_fault(reader, end) for end in value)


def _read_or_fault(reader: Reader, value: object) -> QuantityOrFault:
    try:
        return reader(value)
    except PydanticCustomError as error:
        return error


def _pair_schema(kind: QuantityKind, keys: dict[str, str], required: list[str]) -> dict[str, Any]:
    single = quantity_schema(kind)
    properties = {key: single | {"description": text} for key, text in keys.items()}
    mapping = {
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }
    return {"anyOf": [single, mapping]}


def _bounds_schema(kind: QuantityKind) -> WithJsonSchema:
    keys = {"min": "smallest admissible value", "max": "largest admissible value"}
    return WithJsonSchema(_pair_schema(kind, keys, ["min", "max"]))


def _ranged_schema(kind: QuantityKind) -> WithJsonSchema:
    schema = _pair_schema(kind, {"nominal": "value that the design uses"}, ["nominal"])
    schema["anyOf"][1]["properties"]["range"] = {
        "type": "array",
        "items": quantity_schema(kind),
        "minItems": 2,
        "maxItems": 2,
        "description": "[lowest, highest] value that the proof covers",
    }
    return WithJsonSchema(schema)


ActuatorGain = Annotated[Quantity, _quantity(kinds.ACTUATOR_GAIN), _schema(kinds.ACTUATOR_GAIN)]
RangedActuatorGain = Annotated[
    RangedQuantity, _ranged(kinds.ACTUATOR_GAIN, positive=True), _ranged_schema(kinds.ACTUATOR_GAIN)
]
Duration = Annotated[Quantity, _quantity(kinds.DURATION), _schema(kinds.DURATION)]
RangedDuration = Annotated[
    RangedQuantity, _ranged(kinds.DURATION, positive=True), _ranged_schema(kinds.DURATION)
]
DerivativeGain = Annotated[
    Quantity, _quantity(kinds.DERIVATIVE_GAIN), _schema(kinds.DERIVATIVE_GAIN)
]
Decay = Annotated[Quantity, _quantity(kinds.DECAY, positive=False), _schema(kinds.DECAY)]
DecayRate = Annotated[Quantity, _quantity(kinds.DECAY), _schema(kinds.DECAY)]
Zero = Annotated[Quantity, _quantity(kinds.ZERO), _schema(kinds.ZERO)]
AngularVelocity = Annotated[
    Quantity, _quantity(kinds.ANGULAR_VELOCITY), _schema(kinds.ANGULAR_VELOCITY)
]
SignedAngularVelocity = Annotated[
    Quantity, _quantity(kinds.ANGULAR_VELOCITY, signed=True), _schema(kinds.ANGULAR_VELOCITY)
]
Torque = Annotated[Quantity, _quantity(kinds.TORQUE), _schema(kinds.TORQUE)]
TorqueOrLargest = Annotated[
    Quantity | str,
    ReadBy(lambda value: _read_or_largest(value, kinds.INITIAL_TORQUE)),
    _or_largest_schema(kinds.INITIAL_TORQUE),
]
SignedTorque = Annotated[Quantity, _quantity(kinds.TORQUE, signed=True), _schema(kinds.TORQUE)]
TorqueRate = Annotated[Quantity, _quantity(kinds.TORQUE_RATE), _schema(kinds.TORQUE_RATE)]
Bandwidth = Annotated[Quantity, _quantity(kinds.BANDWIDTH), _schema(kinds.BANDWIDTH)]
LeverArm = Annotated[Quantity, _quantity(kinds.LEVER_ARM), _schema(kinds.LEVER_ARM)]
RotationalStiffness = Annotated[Quantity, _quantity(kinds.SPRING), _schema(kinds.SPRING)]
Impedance = Annotated[Quantity, _quantity(kinds.IMPEDANCE), _schema(kinds.IMPEDANCE)]
IntegralForceGain = Annotated[
    Quantity, _quantity(kinds.INTEGRAL_FORCE_GAIN), _schema(kinds.INTEGRAL_FORCE_GAIN)
]
ForceGain = Annotated[Quantity, _quantity(kinds.FORCE_GAIN), _schema(kinds.FORCE_GAIN)]
Stiffness = Annotated[
    RangedQuantity, _ranged(kinds.STIFFNESS, positive=True), _ranged_schema(kinds.STIFFNESS)
]
Damping = Annotated[
    RangedQuantity, _ranged(kinds.DAMPING, positive=False), _ranged_schema(kinds.DAMPING)
]
PositiveDamping = Annotated[
    RangedQuantity, _ranged(kinds.DAMPING, positive=True), _ranged_schema(kinds.DAMPING)
]
HandMass = Annotated[
    RangedQuantity, _ranged(kinds.HAND_MASS, positive=False), _ranged_schema(kinds.HAND_MASS)
]
Deflection = Annotated[Quantity, _quantity(kinds.DEFLECTION), _schema(kinds.DEFLECTION)]
Mass = Annotated[Quantity, _quantity(kinds.MASS, positive=False), _schema(kinds.MASS)]
RangedMass = Annotated[
    RangedQuantity, _ranged(kinds.MASS, positive=True), _ranged_schema(kinds.MASS)
]
RangedCoordinate = Annotated[
    RangedQuantity, _ranged(kinds.LENGTH, positive=False, signed=True), _ranged_schema(kinds.LENGTH)
]
NoiseDensity = Annotated[Quantity, _quantity(kinds.NOISE_DENSITY), _schema(kinds.NOISE_DENSITY)]
Force = Annotated[Quantity, _quantity(kinds.FORCE), _schema(kinds.FORCE)]
Length = Annotated[Quantity, _quantity(kinds.LENGTH), _schema(kinds.LENGTH)]
Coordinate = Annotated[Quantity, _quantity(kinds.LENGTH, signed=True), _schema(kinds.LENGTH)]
Angle = Annotated[Quantity, _quantity(kinds.ANGLE), _schema(kinds.ANGLE)]
SignedAngle = Annotated[Quantity, _quantity(kinds.ANGLE, signed=True), _schema(kinds.ANGLE)]
MomentOfInertia = Annotated[
    Quantity, _quantity(kinds.INERTIA, positive=False), _schema(kinds.INERTIA)
]
RotorInertia = Annotated[Quantity, _quantity(kinds.INERTIA), _schema(kinds.INERTIA)]
ProductOfInertia = Annotated[
    Quantity, _quantity(kinds.INERTIA, signed=True), _schema(kinds.INERTIA)
]
LinearVelocity = Annotated[
    Quantity, _quantity(kinds.LINEAR_VELOCITY), _schema(kinds.LINEAR_VELOCITY)
]
LinearAcceleration = Annotated[Quantity, _quantity(kinds.ACCELERATION), _schema(kinds.ACCELERATION)]
Gravity = Annotated[
    Quantity, _quantity(kinds.ACCELERATION, positive=False), _schema(kinds.ACCELERATION)
]
AngularAcceleration = Annotated[
    Quantity, _quantity(kinds.ANGULAR_ACCELERATION), _schema(kinds.ANGULAR_ACCELERATION)
]
Command = Annotated[Quantity, _quantity(kinds.COMMAND, positive=False), _schema(kinds.COMMAND)]
LargestCommand = Annotated[Quantity, _quantity(kinds.COMMAND), _schema(kinds.COMMAND)]
TorqueGradient = Annotated[
    Quantity, _quantity(kinds.TORQUE_GRADIENT), _schema(kinds.TORQUE_GRADIENT)
]
LengthBounds = Annotated[Bounds, _bounds(kinds.LENGTH, positive=True), _bounds_schema(kinds.LENGTH)]
