"""One sample of a law as a list of operations: PD control below the compliant laws.

The list is the law, for the program and for the proof. Every coefficient and every result is a
single-precision number:

    x1 = p x1 + q F              (where the force is filtered; then x2 = p x2 + q x1, ...)
    xref = X + ...               (what the parts of the laws add to the commanded position)
    e = xref - theta
    u = Kp e + D (e - e_before)
    ...                          (what the parts compute for the next sample)

The position is taken at the sample, the force sample may be older.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from nrs_design.controllers.laws import DiscreteLaw
from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.controllers.parts import DEFAULT_LIMIT, FORCE, FORCE_GAIN, HAND, POSITION, StepPart
from nrs_design.controllers.sensor import DiscreteLowPass
from nrs_design.models.drive import CommandInterface

UNITS = {"command": "rpm"}
# Name of the limit on the integral of the force error.
INTEGRAL_LIMIT = "integral_limit"
ZERO = Fraction(0)


@dataclass(frozen=True, slots=True)
class StepLimits:
    """Limits of inputs and of signals that saturate; single-precision numbers."""

    # Joint angle and reference beyond it are refused, rad.
    angle: Fraction = DEFAULT_LIMIT
    # The velocity command saturates there, rad/s.
    velocity: Fraction = DEFAULT_LIMIT
    # The speed command of the motor saturates there, rpm; None for nowhere.
    command: Fraction | None = None
    # The integral of the force error is cut off there, rad; None for nowhere.
    integral: Fraction | None = None

    def apply_limit(self, value: Value) -> Value:
        """Return a value, limited by the largest angle if its unit is rad."""
        return replace(value, limit=self.angle) if value.unit == "rad" else value


@dataclass(frozen=True, slots=True)
class StepFrame:
    """Motion controller, filter and limits of all laws of a program."""

    # Gains of the motion controller in rpm/rad: Kp, and Kd over the period.
    Kp: Fraction
    D: Fraction
    # Through which the force passes on its way to the laws.
    low_pass: DiscreteLowPass | None = None
    # By default nothing saturates, and inputs are refused where no robot gets.
    limits: StepLimits = StepLimits()
    # Command interface of a robot with its own motion controller, or with torques.
    interface: CommandInterface | None = None

    @property
    def order(self) -> int:
        """How many lags the filter of the force has."""
        return 0 if self.low_pass is None else self.low_pass.order

    @property
    def streams(self) -> bool:
        """Whether the robot takes velocities or positions, and closes the motion loop."""
        return self.interface in (CommandInterface.VELOCITY, CommandInterface.POSITION)

    @property
    def numbers(self) -> dict[str, Fraction]:
        """The numbers of motion controller and filter, by the names of their coefficients."""
        numbers = {} if self.interface else {"Kp": self.Kp, "Kd_over_T": self.D}
        return numbers | (
            {} if self.low_pass is None else {"p": self.low_pass.p, "q": self.low_pass.q}
        )

    @property
    def coefficients(self) -> Iterator[Coefficient]:
        """Coefficients of the motion controller and of the force filter."""
        symbols = {"Kp": ("Kp", "rpm/rad"), "Kd_over_T": ("D", "rpm/rad")}
        for name, number in self.numbers.items():
            yield Coefficient(name, *symbols.get(name, (name, "1")), (number,))


def step_parts(laws: Collection[DiscreteLaw]) -> tuple[StepPart, ...]:
    """Return the parts of some laws without repetition, position controllers first."""
    position_laws = [law for law in laws if law.law.commands == "position"]
    ordered = (*position_laws, *(law for law in laws if law not in position_laws))
    names = {name for law in laws for name in law.numbers}
    parts = (
        part for law in ordered for part in law.law.parts(names, has_position=bool(position_laws))
    )
    return tuple({part.name: part for part in parts}.values())


def numbers_in_force(
    law: DiscreteLaw, parts: Iterable[StepPart], idle: Fraction | None
) -> dict[str, Fraction]:
    """Return the numbers of all parts while one law is active, by name.

    Those of the law need not be in single precision; `idle` is what a sample leaves of the states
    of laws that are not active.
    """
    found: dict[str, Fraction] = {}
    for part in parts:
        active = _has(law, part)
        for gain in part.gains:
            number = law.numbers.get(gain.name, ZERO) if gain.fixed is None else gain.fixed
            found[gain.name] = number if active else (idle or ZERO) if gain.idle else ZERO
    return found


def _has(law: DiscreteLaw, part: StepPart) -> bool:
    """Tell whether a law has a part."""
    names = {law_part.name for law_part in law.law.parts(law.numbers, has_position=False)}
    return part.name in names


def build_law(
    frame: StepFrame, laws: Mapping[str, DiscreteLaw], idle: Fraction | None = None
) -> StepLaw:
    """Write the laws of controllers out; all admittances have an inertia, or none has.

    Without a motion controller, the command is the velocity that impedance controllers make of the
    sample, or the reference that they move by it. `idle` as for `numbers_in_force`.
    """
    limits, parts = frame.limits, step_parts(laws.values())
    if frame.interface is CommandInterface.VELOCITY:
        parts = tuple(map(_streamed, parts))
    if limits.integral is not None:
        parts = tuple(map(_clamped, parts))
    places = [part.place for part in parts if part.place is not None]
    states = [state for part in reversed(parts) for state in part.states]
    inputs = {value.name: value for part in parts for value in part.inputs}
    takes_position = POSITION.name in inputs
    takes_hand = HAND.name in inputs
    error = Value(
        "error_before",
        "e before",
        "rad",
        2 * (DEFAULT_LIMIT if takes_position else limits.angle),
        "error of motion a sample ago",
        stored="e before [rad]",
    )
    edges = {"velocity_limit": (limits.velocity, "rad/s")} if takes_hand else {}
    edges |= {} if limits.command is None else {"command_limit": (limits.command, "rpm")}
    edges |= {} if limits.integral is None else {INTEGRAL_LIMIT: (limits.integral, "rad")}
    lagging = {f"filtered_{i}": _lagged(i) for i in range(1, frame.order + 1)}
    following = {name: result for part in parts for name, result in part.following.items()}
    first = {place.name: following[place.name] for place in places}
    referred = tuple(_referred(parts, takes_position=takes_position))
    reference_name = "reference" if not takes_position or referred else "position"
    takes_force = any(gain.name == FORCE_GAIN for part in parts for gain in part.gains)
    motion: tuple[Operation, ...] = ()
    if frame.interface is CommandInterface.VELOCITY:
        command = "relative"
    elif frame.streams:
        command = reference_name if takes_position else "next_reference"
    else:
        motion = (*motion_operations(limits, reference_name, takes_force=takes_force),)
        command = motion[-1].name
    operations = (
        *_filtered(frame.order),
        *referred,
        *motion,
        *(operation for part in reversed(parts) for operation in part.state_operations),
    )
    force = {FORCE: _lagged(frame.order)}
    # With a velocity interface, only a virtual spring needs the measured angle.
    takes_angle = frame.interface is not CommandInterface.VELOCITY or any(
        o.first == "angle" for o in operations
    )
    return StepLaw(
        tuple(laws),
        (*_measured(limits)[not takes_angle :], *map(limits.apply_limit, inputs.values())),
        (
            *map(limits.apply_limit, places),
            *(() if frame.streams else (error,)),
            *(limits.apply_limit(state) for state in states if state.stored),
            *_lags(frame.order),
            *(limits.apply_limit(state) for state in states if not state.stored),
        ),
        (
            *frame.coefficients,
            *_coefficients(laws.values(), parts, idle),
            *(Coefficient(name, "", unit, (edge,)) for name, (edge, unit) in edges.items()),
        ),
        tuple(
            replace(o, first=force.get(o.first, o.first), second=force.get(o.second, o.second))
            for o in operations
        ),
        {"command": command},
        {**first, **({} if frame.streams else {"error_before": "error"}), **lagging, **following},
        UNITS,
    )


def _streamed(part: StepPart) -> StepPart:
    """Return the part of an admittance that moves no reference: its velocity is the command.

    A velocity that is a state is taken after the sample. A spring draws the measured position.
    """
    newest = part.following.get("velocity", "velocity")
    sprung = "commanded" in part.following
    changes: dict[str, dict[str, Any]] = {
        "offset": {"first": "angle"},
        "relative": {"second": newest},
        # The command alone uses the velocity, so its rounding counts as a term there.
        "velocity": {"rounding": "term", "symbol": ""},
    }
    after = (
        replace(operation, **changes.get(operation.name, {}))
        for operation in part.state_operations
        if operation.name not in ("moved", "next_reference")
    )
    return replace(
        part,
        place=None,
        gains=tuple(gain for gain in part.gains if sprung or gain.name != "T"),
        state_operations=tuple(after),
        following={name: result for name, result in part.following.items() if name != "reference"},
    )


def _clamped(part: StepPart) -> StepPart:
    """Return the part of an integral that is cut off: what is summed up saturates, unrounded."""
    integral = part.following.get("integral")
    if integral is None:
        return part
    *before, last = part.state_operations
    summed = replace(last, name="summed_integral")
    limit = Operation(integral, "saturate", INTEGRAL_LIMIT, summed.name)
    return replace(part, state_operations=(*before, summed, limit))


def _coefficients(
    laws: Collection[DiscreteLaw], parts: Iterable[StepPart], idle: Fraction | None
) -> Iterator[Coefficient]:
    mixed_commands = len({law.law.commands for law in laws}) > 1
    for part in parts:
        law_numbers = [numbers_in_force(law, (part,), idle) for law in laws]
        for gain in part.gains:
            values = tuple(numbers[gain.name] for numbers in law_numbers)
            symbols = tuple(gain.symbol if _has(law, part) else gain.idle for law in laws)
            yield Coefficient(
                gain.name,
                gain.symbol,
                gain.unit,
                values[:1] if gain.common and not mixed_commands else values,
                symbols=symbols if gain.idle else (),
            )


def _measured(limits: StepLimits) -> tuple[Value, ...]:
    angle = Value("angle", "theta", "rad", DEFAULT_LIMIT, "measured position of the joint", "angle")
    torque = Value(
        "torque", "F", "N*m", DEFAULT_LIMIT, "measured torque, or force, of the contact", "term"
    )
    return limits.apply_limit(angle), torque


def _referred(parts: Iterable[StepPart], *, takes_position: bool) -> Iterator[Operation]:
    """Yield the sum of the commanded position and of all parts."""
    total = ""
    for part in parts:
        yield from part.reference_operations
        if part.adds and total:
            yield Operation(part.total, "add", part.adds, total)
        total = part.total if part.adds and total else part.adds or total
    if takes_position and total:
        yield Operation("reference", "add", "position", total, "angle")


def motion_operations(
    limits: StepLimits, reference: str = "reference", *, takes_force: bool = False
) -> Iterator[Operation]:
    """Yield the PD controller, from a reference and ``angle`` to ``command``.

    `takes_force`: a share of the force is added, which makes ``eased`` of ``command``.
    """
    yield Operation("error", "subtract", reference, "angle", "own", "e")
    yield Operation("proportional", "multiply", "Kp", "error")
    yield Operation("change", "subtract", "error", "error_before")
    yield Operation("derivative", "multiply", "Kd_over_T", "change")
    yield Operation("command", "add", "proportional", "derivative")
    if takes_force:
        yield Operation("easing", "multiply", FORCE_GAIN, FORCE)
        yield Operation("eased", "subtract", "command", "easing")
    if limits.command is not None:
        source = "eased" if takes_force else "command"
        yield Operation("limited_command", "saturate", "command_limit", source)


def _lags(order: int) -> Iterator[Value]:
    """Yield the states of a filter with so many lags."""
    for i in range(1, order + 1):
        meaning = f"torque behind lag {i} of the filter"
        stored = f"filtered {i} before [N*m]"
        yield Value(f"filtered_{i}", f"x{i}", "N*m", DEFAULT_LIMIT, meaning, stored=stored)


def _lagged(order: int) -> str:
    """Return the name of the force behind so many lags."""
    return f"next_filtered_{order}" if order else "torque"


def _filtered(order: int) -> Iterator[Operation]:
    """Yield the operations of the filter lags in series."""
    for i in range(1, order + 1):
        yield Operation(f"kept_{i}", "multiply", "p", f"filtered_{i}")
        yield Operation(f"added_{i}", "multiply", "q", _lagged(i - 1))
        yield Operation(_lagged(i), "add", f"kept_{i}", f"added_{i}")
