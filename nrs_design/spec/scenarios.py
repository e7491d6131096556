"""Scenarios of a spec: commands of the surgeon, places of tissue, and active controllers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Annotated, Any, Literal, TypeVar

from pydantic import Field

from nrs_design.proof.text import quoted
from nrs_design.spec import kinds
from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row
from nrs_design.spec.faults import all_of, as_text, fault
from nrs_design.spec.fields import LABEL_PATTERN, Label, Title, UnitFraction, whole
from nrs_design.spec.model import ParsedBy, SpecModel, optional, pair_schema, required
from nrs_design.spec.quantity import Quantity, is_less
from nrs_design.spec.quantity_fields import quantity_schema, read_quantity

T = TypeVar("T")

MAX_POINTS, MAX_SURFACES, LONGEST = 1000, 16, 3600
LARGEST_SEED = 2**32 - 1

Points = tuple[tuple[Quantity, Quantity], ...]


def _read_timed(
    value: object, least: int, form: str, read: Callable[[object, int], T], *, jumps: bool = False
) -> tuple[tuple[Quantity, T], ...]:
    """Read pairs of a time and something else; times rise from zero, or stay where it jumps."""
    if not isinstance(value, list | tuple) or not least <= len(value) <= MAX_POINTS:
        raise fault(f"expected a list of pairs, {least} to {MAX_POINTS}", f"write {form}")

    def read_pair(i: int, item: object) -> tuple[Quantity, T]:
        if not isinstance(item, list | tuple) or len(item) != 2:
            raise fault("expected a time and what belongs to it", f"write {form}", i)
        return read_quantity(item[0], kinds.DURATION, i, 0, positive=False), read(item[1], i)

    pairs = tuple(all_of(*(partial(read_pair, i, item) for i, item in enumerate(value))))
    for i, (time, _) in enumerate(pairs):
        before = pairs[i - 1][0]
        rises = is_less(before, time) or (jumps and not is_less(time, before))
        if not rises if i else time.value:
            remedy = f"begin at 0 s, and let times rise, as in {form}"
            raise fault(f"the time {quoted(time.text)} is not in order", remedy, i, 0)
    return pairs


def _read_points(value: object) -> Points:
    def read(item: object, i: int) -> Quantity:
        return read_quantity(item, kinds.ANGULAR_VELOCITY, i, 1, positive=False, signed=True)

    return _read_timed(value, 2, "[[0 s, 0 deg/s], [1 s, 8 deg/s], ...]", read, jumps=True)


def _read_schedule(value: object) -> tuple[tuple[Quantity, str], ...]:
    form = "[[0 s, insertion], [2 s, withdrawal], ...]"
    return _read_timed(value, 1, form, lambda item, i: as_text(item, i, 1))


def _pairs(first: dict[str, Any], second: dict[str, Any], least: int) -> dict[str, Any]:
    pairs = pair_schema([first, second])
    return {"type": "array", "items": pairs, "minItems": least, "maxItems": MAX_POINTS}


_TIME = quantity_schema(kinds.DURATION)
Breakpoints = Annotated[
    Points, ParsedBy(_read_points, _pairs(_TIME, quantity_schema(kinds.ANGULAR_VELOCITY), 2))
]
Schedule = Annotated[
    tuple[tuple[Quantity, str], ...],
    ParsedBy(_read_schedule, _pairs(_TIME, {"type": "string", "pattern": LABEL_PATTERN}, 1)),
]
Seed = Annotated[int, whole(0, LARGEST_SEED)]


def one_of(message: str, remedy: str) -> tuple[Row[Any], ...]:
    """Return the check that just one field of a model is given."""
    return (Row("", lambda s: sum(v is not None for _, v in s) != 1, message, remedy),)


class SinusoidSpec(SpecModel, stronger="unknown", unsaid="other"):
    """A velocity ``offset + amplitude sin(omega t)``."""

    amplitude: field.AngularVelocity = required("amplitude in rad/s")
    frequency: field.Bandwidth = required("frequency in Hz, or rad/s")
    offset: field.SignedAngularVelocity | None = optional("mean in rad/s; default: none")


class CommandProfileSpec(SpecModel, stronger="unknown", unsaid="other"):
    """The velocity that the surgeon commands, in one of three ways; positive raises the angle."""

    constant: field.SignedAngularVelocity | None = optional("one velocity all the time, in rad/s")
    points: Breakpoints | None = optional(
        "[[time, velocity], ...], straight lines between; a time twice is a jump, the last is kept"
    )
    sinusoid: SinusoidSpec | None = optional("{amplitude: ..., frequency: ..., offset: ...}")

    checks = one_of("a command is given in one way", "write constant, points or sinusoid")


class SurfaceSpec(SpecModel, stronger="unknown", unsaid="other"):
    """Where an environment begins; it pushes and never pulls."""

    environment: Label = required("name of the environment")
    at: field.SignedAngle = required("angle of its surface in rad")
    side: Literal["above", "below"] = optional(
        "above: for rising angles; below: for falling", "above"
    )
    parameters: Literal["nominal", "lowest", "highest"] = optional(
        "which end of its ranges it has: all parameters alike", "nominal"
    )


Surfaces = Annotated[tuple[SurfaceSpec, ...], Field(max_length=MAX_SURFACES)]


class SignControlSpec(SpecModel, stronger="unknown", unsaid="other"):
    """Insertion and withdrawal by the signs of command and torque (thesis 6.3.2)."""

    insertion: Label = required("controller while the command goes into the tissue")
    withdrawal: Label = required("controller while the command goes out of tissue that pushes")


class ThresholdControlSpec(SpecModel, stronger="unknown", unsaid="other"):
    """Position control up to a torque, force control from there on (thesis 6.3.3)."""

    position: Label = required("controller below the threshold")
    force: Label = required("controller from the threshold on, until the command is out")
    torque: field.Torque = required("the threshold T_th in N*m")


class ControlSpec(SpecModel, stronger="unknown", unsaid="other"):
    """Which controller is in force when, in one of six ways."""

    fixed: Label | None = optional("one controller all the time")
    schedule: Schedule | None = optional("[[0 s, insertion], [2 s, withdrawal], ...]")
    sign: SignControlSpec | None = optional("{insertion: ..., withdrawal: ...}, by the signs")
    contact: Annotated[dict[Label, Label], Field(min_length=1)] | None = optional(
        "environment -> controller, by the last contact (thesis 6.4), such as {soft: tissue}; the "
        "first one before any contact"
    )
    threshold: ThresholdControlSpec | None = optional("{position: ..., force: ..., torque: ...}")
    logic: Literal["mode-logic"] | None = optional("mode-logic: as the spec's mode_logic says")

    checks = one_of(
        "control is given in one way", "write fixed, schedule, sign, contact, threshold or logic"
    )

    @property
    def named(self) -> Mapping[tuple[str | int, ...], str]:
        """Every controller that is named, by its place."""
        found: dict[tuple[str | int, ...], str] = {}
        if self.fixed is not None:
            found["fixed",] = self.fixed
        for i, (_, name) in enumerate(self.schedule or ()):
            found["schedule", i, 1] = name
        for key in ("sign", "threshold"):
            for role, name in getattr(self, key) or ():
                if isinstance(name, str):
                    found[key, role] = name
        for environment, name in (self.contact or {}).items():
            found["contact", environment] = name
        return found


class ErrorsSpec(SpecModel, stronger="larger"):
    """Disturbances of the sampled loop and errors of its sensors; a missing key is zero."""

    friction: field.DriveCommand | None = optional("Coulomb friction as a command, such as rpm")
    encoder_step: field.Angle | None = optional("resolution of the measured joint angle in rad")
    force_step: field.Torque | None = optional("resolution of the measured torque in N*m")
    force_noise: field.Torque | None = optional("standard deviation of torque noise in N*m")
    jitter: UnitFraction | None = optional("how late a sample may be, as a share of the period")


class ScenarioLimitsSpec(SpecModel, stronger="smaller"):
    """Limits of a simulated run for the gate; a missing key is not checked."""

    torque: field.Torque | None = optional("largest torque of the tissue in N*m")
    deflection: field.Angle | None = optional("largest depth below a surface in rad")
    velocity: field.AngularVelocity | None = optional("largest speed of the axis in rad/s")

    checks = (
        Row("", lambda s: not s.named, "no limit is named", "name torque, deflection or velocity"),
    )

    @property
    def named(self) -> Mapping[str, Quantity]:
        """The limits that there are, by quantity."""
        return {name: value for name, value in self if value is not None}


class ScenarioSpec(SpecModel, stronger="unknown", unsaid="other"):
    """One run of the robot against its surroundings."""

    title: Title = optional("one line for people, at most 200 characters", "", stronger="beside")
    command: CommandProfileSpec = required("velocity that the surgeon commands")
    duration: field.Duration | None = optional(
        "length in s, at most an hour; default: that of points", stronger="larger"
    )
    start: field.SignedAngle | None = optional("angle in rad at the start, at rest; default: 0")
    surfaces: Surfaces = optional("what is touched where; forces add up; default: nothing", ())
    control: ControlSpec | None = optional("who is in force; default: mode_logic, or the first")
    wanted_torque: field.Torque | None = optional(
        "Fd in N*m, to rising angles; default: limits.torque"
    )
    errors: ErrorsSpec | None = optional("errors of the sampled engine", unsaid="nothing")
    limits: ScenarioLimitsSpec | None = optional(
        "limits for the gate (NRS109), such as {torque: 0.3 N*m}; default: no simulation",
        unsaid="nothing",
    )
    seed: Seed = optional("of noise, jitter and varying delay", 0)

    def _too_long(self) -> tuple[str, str] | None:
        """Return the key of a length that is not simulated, and the length."""
        key = "duration" if self.duration is not None else "command"
        if self.length is None or 0 < self.length.exact <= LONGEST:
            return None
        return key, quoted(self.length.text)

    checks = (
        Row(
            "",
            lambda s: s.length is None,
            "nothing says how long the run is",
            "add `duration: 10 s`",
        ),
        Row(
            "{0}",
            _too_long,
            "a run of {1} is not simulated",
            f"write a duration above zero, up to {LONGEST} s",
        ),
    )

    @property
    def length(self) -> Quantity | None:
        """Length of the run in s, as far as the spec itself says it."""
        if self.duration is None and self.command.points is not None:
            return self.command.points[-1][0]
        return self.duration
