"""Field types for quantities, bounds and ranges."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import partial
from typing import Annotated, Any, Literal, NamedTuple

from nrs_design.errors import SpecError
from nrs_design.models.axis import current
from nrs_design.models.interval import Interval
from nrs_design.proof.text import quoted
from nrs_design.spec import kinds
from nrs_design.spec.check import Row
from nrs_design.spec.faults import all_of, as_text, fault, reported
from nrs_design.spec.model import (
    ExpandedBy,
    ParsedBy,
    SpecModel,
    keys_schema,
    optional,
    pair_schema,
    required,
)
from nrs_design.spec.parameters import BOUND_CHECKS, RANGE_CHECKS, Switch, range_around
from nrs_design.spec.quantity import (
    QUANTITY_PATTERN,
    Quantity,
    QuantityKind,
    is_less,
    parse_quantity,
)

# Reads a value that stands at a place, for faults.
Reader = Callable[..., Quantity]


def read_quantity(
    value: object, kind: QuantityKind, *at: int | str, positive: bool = True, signed: bool = False
) -> Quantity:
    """Read a quantity of a kind from text, and check its sign unless it is ``signed``.

    `positive` refuses zero too; `at` is where it stands, for faults.
    """
    kind = kind.on(current())

    def read() -> Quantity:
        quantity = parse_quantity(as_text(value, *at), kind)
        if not signed and (quantity.value < 0 or (positive and quantity.value == 0)):
            bound = "positive" if positive else "zero or positive"
            above = f"write a number above zero{kind.example_clause}"
            raise SpecError(
                f"{quoted(quantity.text)} must be {bound}",
                remedy="check the sign" if quantity.value else above,
            )
        return quantity

    return reported(read, *at)


def quantity_schema(kind: QuantityKind) -> dict[str, Any]:
    """JSON Schema of a quantity of this kind."""
    return {"type": "string", "pattern": QUANTITY_PATTERN, "examples": [kind.example]}


def _reader(kind: QuantityKind, **signs: bool) -> Reader:
    return lambda value, *at: read_quantity(value, kind, *at, **signs)


def _one(kind: QuantityKind, **signs: bool) -> ParsedBy:
    return ParsedBy(_reader(kind, **signs), quantity_schema(kind))


# In the place of a quantity: as large as is found.
LARGEST: Literal["largest"] = "largest"


def _or_largest(kind: QuantityKind) -> ParsedBy:
    """Read both in one place, so that a text that is neither is one fault."""

    def read(value: object) -> Quantity | Literal["largest"]:
        if value == LARGEST:
            return LARGEST
        if isinstance(value, str) and not any(map(str.isdigit, value)):
            meant = kind.on(current())
            raise fault(
                f"{quoted(value)} is neither {meant.name} nor {LARGEST!r}",
                f"write {meant.example!r}, or {LARGEST!r}",
            )
        return read_quantity(value, kind)

    return ParsedBy(read, {"anyOf": [quantity_schema(kind), {"const": LARGEST}]})


def _as_is(value: object) -> Quantity:
    if not isinstance(value, Quantity):
        raise fault("expected a quantity", "write a number, a space and a unit")
    return value


# Inside bounds and ranges: the field around them knows the kind and reads the text.
AnyQuantity = Annotated[Quantity, ParsedBy(_as_is, {"type": "string", "pattern": QUANTITY_PATTERN})]


class Bounds(SpecModel, stronger="unknown"):
    """Closed interval."""

    min: AnyQuantity = required("smallest admissible value")
    max: AnyQuantity = required("largest admissible value")

    checks = BOUND_CHECKS


class GainSpec(SpecModel, stronger="neither"):
    """A gain: fixed, with ``min == max``, or to be designed within bounds."""

    min: AnyQuantity = required("smallest value that the design may choose")
    max: AnyQuantity = required("largest value that the design may choose")

    checks = BOUND_CHECKS

    @property
    def fixed(self) -> bool:
        """Whether the design may choose only one value."""
        return self.min.rational_part == self.max.rational_part


class RangedQuantity(SpecModel):
    """Nominal value of an uncertain quantity, and the interval that it lies in.

    Without an interval in the spec, both ends are the nominal value.
    """

    nominal: AnyQuantity = required("value that the design uses")
    range: tuple[AnyQuantity, AnyQuantity] = range_around(
        "[lowest, highest] value that is proved; default: the nominal one"
    )

    varies: Switch = optional("true: changes arbitrarily fast; false: an unknown constant", True)

    checks = (
        *RANGE_CHECKS,
        Row(
            "varies",
            lambda s: not s.varies and "range" not in s.model_fields_set,
            "a constant that has one value: there is no range",
            "add `range: [lowest, highest]`, or remove varies",
        ),
    )

    @property
    def fixed(self) -> bool:
        """Whether the range is a single value."""
        return self.range[0].rational_part == self.range[1].rational_part

    @property
    def interval(self) -> Interval:
        """The same in SI, exactly; a ValueError where a unit holds a pi."""
        low, high = (end.exact for end in self.range)
        return Interval(self.nominal.exact, low, high, self.varies)


def bounds_of(kind: QuantityKind, model: type[SpecModel], *, positive: bool = True) -> ExpandedBy:
    """Read the smallest and the largest of a quantity, the keys of a model; or one for both."""
    keys = {key: field.description for key, field in model.model_fields.items()}
    reader = _reader(kind, positive=positive)

    def read(value: object) -> object:
        if isinstance(value, str):
            return dict.fromkeys(keys, reader(value))
        return _read_keys(value, dict.fromkeys(keys, reader))

    single = quantity_schema(kind)
    described = {key: single | {"description": text} for key, text in keys.items()}
    return ExpandedBy(read, {"anyOf": [single, keys_schema(described, *keys)]})


def _ranged(kind: QuantityKind, *, positive: bool = True) -> ExpandedBy:
    """Read a quantity with a range, in which it may be said to be constant."""
    reader = _reader(kind, positive=positive)

    def read(value: object) -> object:
        if isinstance(value, str):
            return {"nominal": reader(value)}
        return _read_keys(value, {"nominal": reader, "range": partial(_read_range, reader)})

    single = quantity_schema(kind)
    each = {"nominal": single, "range": pair_schema(single), "varies": {"type": "boolean"}}
    keys = {
        key: {**each[key], "description": field.description}
        for key, field in RangedQuantity.model_fields.items()
    }
    return ExpandedBy(read, {"anyOf": [single, keys_schema(keys, "nominal")]})


def _read_keys(value: object, readers: Mapping[str, Callable[..., object]]) -> object:
    """Read the entries that are quantities; the model reports other faults."""
    if not isinstance(value, dict):
        return value
    reads = {key: partial(readers[key], value[key], key) for key in value if key in readers}
    return value | dict(zip(reads, all_of(*reads.values()), strict=True))


def _read_range(reader: Reader, value: object, *at: str) -> tuple[Quantity, ...]:
    """Read both ends of a range."""
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise fault("expected two quantities", "write [lowest, highest]", *at)
    return tuple(all_of(*(partial(reader, end, *at, i) for i, end in enumerate(value))))


class Times(NamedTuple):
    """The shortest and the longest time, and whether it is another one each time."""

    shortest: Quantity
    longest: Quantity
    varies: bool = True

    @property
    def is_constant(self) -> bool:
        """Tell whether it has a range, and is constant within it."""
        return not self.varies and is_less(self.shortest, self.longest)


_CONSTANT_TIMES = "write `{range: [0.3 ms, 0.8 ms], varies: false}`"


def _read_times(value: object) -> Times:
    """Read one time, or the shortest and the longest time; a time in between may be constant."""
    if not isinstance(value, dict):
        return _between(value)
    if not {"range"} <= value.keys() <= {"range", "varies"}:
        raise fault("expected a range, and whether it varies", _CONSTANT_TIMES)
    varies = {"true": True, "false": False}.get(str(value.get("varies", "true")).lower())
    if varies is None:
        raise fault("expected true or false", _CONSTANT_TIMES, "varies")
    found = _between(value["range"])
    if not varies and not is_less(found.shortest, found.longest):
        raise fault("a constant that may have one value is known", "write it as one time", "varies")
    return found._replace(varies=varies)


def _between(value: object) -> Times:
    ends = tuple(value) if isinstance(value, tuple | list) else (value, value)
    if len(ends) != 2:
        raise fault("expected a time, or two of them", "write `0.4 ms`, or `[0.3 ms, 0.8 ms]`")
    low, high = (read_quantity(end, kinds.DURATION, positive=False) for end in ends)
    if is_less(high, low):
        raise fault("the range of the times ends below its start", "write [shortest, longest]")
    return Times(low, high)


def ends_of(times: Times | None) -> tuple[Fraction, Fraction]:
    """Return the shortest and the longest time in s; none is no time."""
    return (times[0].exact, times[1].exact) if times else (Fraction(0), Fraction(0))


_TIMES = pair_schema(quantity_schema(kinds.DURATION))
_RANGED_TIMES = keys_schema(
    {
        "range": _TIMES | {"description": "[shortest, longest] time that the proof covers"},
        "varies": {
            "type": "boolean",
            "description": "false: it is unknown, but always the same; default: true",
        },
    },
    "range",
)
# One time for both ends, or a range, within which it may be constant.
TimeRange = Annotated[
    Times,
    ParsedBy(_read_times, {"anyOf": [quantity_schema(kinds.DURATION), _TIMES, _RANGED_TIMES]}),
]
ActuatorGain = Annotated[Quantity, _one(kinds.ACTUATOR_GAIN)]
RangedActuatorGain = Annotated[RangedQuantity, _ranged(kinds.ACTUATOR_GAIN)]
Duration = Annotated[Quantity, _one(kinds.DURATION)]
RangedDuration = Annotated[RangedQuantity, _ranged(kinds.DURATION)]
DerivativeGain = Annotated[Quantity, _one(kinds.DERIVATIVE_GAIN)]
Decay = Annotated[Quantity, _one(kinds.DECAY, positive=False)]
DecayRate = Annotated[Quantity, _one(kinds.DECAY)]
Zero = Annotated[Quantity, _one(kinds.ZERO)]
AngularVelocity = Annotated[Quantity, _one(kinds.ANGULAR_VELOCITY)]
SignedAngularVelocity = Annotated[Quantity, _one(kinds.ANGULAR_VELOCITY, signed=True)]
Torque = Annotated[Quantity, _one(kinds.TORQUE)]
TorqueOrLargest = Annotated[Quantity | Literal["largest"], _or_largest(kinds.INITIAL_TORQUE)]
SignedTorque = Annotated[Quantity, _one(kinds.TORQUE, signed=True)]
TorqueRate = Annotated[Quantity, _one(kinds.TORQUE_RATE)]
Bandwidth = Annotated[Quantity, _one(kinds.BANDWIDTH)]
LeverArm = Annotated[Quantity, _one(kinds.LEVER_ARM)]
RotationalStiffness = Annotated[Quantity, _one(kinds.SPRING)]
Impedance = Annotated[Quantity, _one(kinds.IMPEDANCE)]
RangedImpedance = Annotated[RangedQuantity, _ranged(kinds.IMPEDANCE)]
NonnegativeImpedance = Annotated[Quantity, _one(kinds.IMPEDANCE, positive=False)]
IntegralForceGain = Annotated[Quantity, _one(kinds.INTEGRAL_FORCE_GAIN)]
ForceGain = Annotated[Quantity, _one(kinds.FORCE_GAIN)]
Stiffness = Annotated[RangedQuantity, _ranged(kinds.STIFFNESS)]
Damping = Annotated[RangedQuantity, _ranged(kinds.DAMPING, positive=False)]
PositiveDamping = Annotated[RangedQuantity, _ranged(kinds.DAMPING)]
HandMass = Annotated[RangedQuantity, _ranged(kinds.HAND_MASS, positive=False)]
Deflection = Annotated[Quantity, _one(kinds.DEFLECTION)]
Mass = Annotated[Quantity, _one(kinds.MASS, positive=False)]
Length = Annotated[Quantity, _one(kinds.LENGTH)]
Coordinate = Annotated[Quantity, _one(kinds.LENGTH, signed=True)]
Angle = Annotated[Quantity, _one(kinds.ANGLE)]
Phase = Annotated[Quantity, _one(kinds.PHASE)]
SignedAngle = Annotated[Quantity, _one(kinds.ANGLE, signed=True)]
MomentOfInertia = Annotated[Quantity, _one(kinds.INERTIA, positive=False)]
RangedInertia = Annotated[RangedQuantity, _ranged(kinds.INERTIA)]
RotorInertia = Annotated[Quantity, _one(kinds.INERTIA)]
ProductOfInertia = Annotated[Quantity, _one(kinds.INERTIA, signed=True)]
LinearVelocity = Annotated[Quantity, _one(kinds.LINEAR_VELOCITY)]
LinearAcceleration = Annotated[Quantity, _one(kinds.ACCELERATION)]
Gravity = Annotated[Quantity, _one(kinds.ACCELERATION, positive=False)]
AngularAcceleration = Annotated[Quantity, _one(kinds.ANGULAR_ACCELERATION)]
Command = Annotated[Quantity, _one(kinds.COMMAND, positive=False)]
DriveCommand = Annotated[Quantity, _one(kinds.DRIVE_COMMAND, positive=False)]
LargestCommand = Annotated[Quantity, _one(kinds.COMMAND)]
TorqueGradient = Annotated[Quantity, _one(kinds.TORQUE_GRADIENT)]
LengthBounds = Annotated[Bounds, bounds_of(kinds.LENGTH, Bounds)]
InertiaGain = Annotated[GainSpec, bounds_of(kinds.INERTIA, GainSpec, positive=False)]
DampingGain = Annotated[GainSpec, bounds_of(kinds.IMPEDANCE, GainSpec)]
# No design chooses it.
SpringGain = Annotated[
    GainSpec, ExpandedBy(bounds_of(kinds.SPRING, GainSpec).read, quantity_schema(kinds.SPRING))
]
