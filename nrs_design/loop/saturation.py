"""Saturating signals of a loop: the motor command, and in continuous time the velocity command.

In continuous time the admittance commands the velocity v. The motion loop integrates ``e' = sat(v)
- omega`` and commands the motor ``u = Kp e + Kd (sat(v) - omega)``. The driver takes ``sat(u)``:
``tau omega' = Km sat(u) - omega``, less the share of a load. The processor cuts off u, and the
velocity command of the hand.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from nrs_design.controllers.float32 import float32_not_above
from nrs_design.loop.located import LocatedMode
from nrs_design.loop.program import CUT_OFF, INPUTS, LAST_ERROR
from nrs_design.loop.sampled import SampledLoop
from nrs_design.loop.shared_state import SharedState
from nrs_design.models.actuator import Actuator
from nrs_design.models.contact.environment import Environment
from nrs_design.models.linear_form import ONE, ZERO, LinearForm, combine, coordinates, zero
from nrs_design.models.motion_loop import JointMotionLoop, Realization
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.bounds import rounded_up
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.saturation import CutOff, Saturation, Start
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec.build_plant import OperatingConditions
from nrs_design.spec.motion import MOTOR_COMMAND

# States of a motion loop in its physical state, `nrs_design.models.motion_loop.JointMotionLoop`.
_ERROR, _OMEGA = 0, 1
INTEGRAL = "integral [rad]"
ERROR_BEFORE = "error of motion a sample ago"


def add_saturation(
    system: SwitchedSystem, conditions: OperatingConditions, actuator: Actuator, state: SharedState
) -> SwitchedSystem:
    """Let a statement be about motions in which velocity command and motor command saturate.

    The motor is the nominal one; limits and goal are as `nrs_design.spec.combinations` checks.
    """
    assert conditions.largest_command is not None  # `nrs_design.spec.combinations` requires it.
    motion, low_pass, modes = state.motion, state.low_pass, system.every_mode
    drive = actuator.gain / actuator.time_constant
    error, omega, columns = _physical(motion, system.order)
    Kp, Kd = state.design.motion.Kp, state.design.motion.Kd
    motor = _row([*combine((Kp, error), (-Kd, omega)), Kd])
    # In the physical state the error accelerates the joint by Km Kp/tau.
    drives = [
        drive if state.joint is None else mode.A.fractions()[_OMEGA][_ERROR] / Kp for mode in modes
    ]
    velocity, unit = float32_not_above(conditions.velocity), conditions.axis.unit("rad/s")
    command = float32_not_above(conditions.largest_command)
    signals = (
        CutOff(
            name="velocity command",
            unit=unit,
            limit=velocity,
            columns=(_column(columns[0]),) * len(modes),
            rows=tuple(_row(_velocity_command(mode, motion)) for mode in modes),
        ),
        CutOff(
            name="motor command",
            unit=conditions.command,
            limit=command,
            columns=tuple(_column([share * entry for entry in columns[1]]) for share in drives),
            rows=(motor,) * len(modes),
        ),
    )
    lags = () if low_pass is None else low_pass.states
    start = _start(conditions, _rest_states(system.states, state.environments, lags))
    assumption = Assumption.create(
        "limited.signals",
        velocity=rounded_up(velocity, unit),
        command=rounded_up(command, conditions.command),
        filtered=low_pass and "filter",
    )
    assumptions = (*system.assumptions, assumption)
    return replace(system, saturation=Saturation(signals, start), assumptions=assumptions)


def add_sampled_saturation(
    system: SwitchedSystem,
    conditions: OperatingConditions,
    loop: SampledLoop,
    modes: Sequence[LocatedMode],
    environments: Sequence[Environment],
) -> SwitchedSystem:
    """Let a statement be about motions in which the command of the motor saturates, sampled.

    Modes of free motion come last; limit and goal are as `nrs_design.spec.combinations` checks.
    """
    assert conditions.largest_command is not None  # `nrs_design.spec.combinations` requires it.
    n, wide = len(loop.states), len(loop.states) + len(INPUTS)

    def errors(rows: Iterable[LinearForm]) -> tuple[RationalMatrix, ...]:
        """Return the shares of the roundings in some signals."""
        return tuple(_row(row[wide:]) for row in rows) if system.roundings else ()

    commands = [mode.period.command for mode in modes]
    signals = [
        CutOff(
            name=MOTOR_COMMAND,
            unit=conditions.command,
            limit=float32_not_above(conditions.largest_command),
            columns=tuple(mode.column(INPUTS.index(CUT_OFF)) for mode in modes),
            rows=tuple(_row(command[:n]) for command in commands),
            errors=errors(commands),
        )
    ]
    if conditions.largest_integral is not None:
        k = loop.states.index(INTEGRAL)
        integrals = [mode.period.moves[k] for mode in modes]
        signals.append(
            CutOff(
                name="integral of the force error",
                unit=conditions.axis.unit("rad"),
                limit=float32_not_above(conditions.largest_integral),
                columns=(_column(coordinates(n)[k]),) * len(modes),
                # The integral does not depend on the saturated command.
                rows=tuple(_row([*row[:n], ZERO]) for row in integrals),
                errors=errors(integrals),
            )
        )
    is_position = any(law.law.commands == "position" for law in loop.program.laws)
    states = _rest_states(system.states, environments, loop.shown_later)
    if is_position:
        states = [*_settle_error(loop, commands, states)]
    command, *integral = [rounded_up(signal.limit, signal.unit) for signal in signals]
    assumption = Assumption.create(
        "limited.sampled",
        command=command,
        clamped=bool(integral) and "integral",
        integral=tuple(integral),
        filtered=bool(loop.shown_later) and "samples",
    )
    start = _start(conditions, states, ERROR_BEFORE if is_position else "")
    return replace(
        system,
        saturation=Saturation(tuple(signals), start),
        assumptions=(*system.assumptions, assumption),
    )


def _settle_error(
    loop: SampledLoop, commands: Iterable[LinearForm], states: Iterable[RationalMatrix]
) -> Iterator[RationalMatrix]:
    """Yield states at rest in which the error of a sample ago is that of now, in any mode.

    The command ``Kp e + D (e - e before)`` is ``(Kp + D) e`` where the error before is zero.
    """
    before, n = loop.states.index(loop.program.stored[LAST_ERROR]), len(loop.states)
    gain = loop.program.step.Kp + loop.program.step.D
    distinct = {tuple(command[:n]) for command in commands}
    found: dict[RationalMatrix, None] = {}
    for state in states:
        (x,) = zip(*state.fractions(), strict=True)
        for command in distinct:
            error = sum((c * v for c, v in zip(command, x, strict=True)), ZERO) / gain
            found[_column([*x[:before], error, *x[before + 1 :]])] = None
    yield from found


def _start(
    conditions: OperatingConditions, states: Iterable[RationalMatrix], extra: str = ""
) -> Start:
    force, unit = conditions.initial_force, conditions.axis.unit("N*m")
    largest = None if isinstance(force, str) else force
    return Start("contact force", unit, tuple(states), largest, extra)


def _physical(
    motion: Realization | JointMotionLoop, n: int
) -> tuple[LinearForm, LinearForm, tuple[LinearForm, LinearForm]]:
    """Return e and omega as forms of the state, and the state change of a change in each."""
    omega, unit = motion.output(n), coordinates(n)
    error = unit[_ERROR] if isinstance(motion, JointMotionLoop) else motion.integral(zero(n))
    (a, b), (c, d) = error[:2], omega[:2]
    determinant, zeros = a * d - b * c, zero(n - 2)
    first = [d / determinant, -c / determinant, *zeros]
    second = [-b / determinant, a / determinant, *zeros]
    return error, omega, (first, second)


def _velocity_command(mode: Mode, motion: Realization | JointMotionLoop) -> LinearForm:
    """Return the velocity that the law commands in a mode: the input of its motion loop."""
    A = mode.A.fractions()
    k = _ERROR if isinstance(motion, JointMotionLoop) else motion.order - 1
    return combine((ONE, A[k]), (-ONE, motion.rates(zero(len(A)))[k]))


def _rest_states(
    states: Sequence[str], environments: Sequence[Environment], lags: Collection[str]
) -> list[RationalMatrix]:
    """Return the states at rest with a unit of force, at every stiffness.

    Signals that show the force later, such as its filter, may not have seen it yet, or be settled.
    """
    unit = coordinates(len(states))
    settled = [Fraction(int(state in lags)) for state in states]
    sensed = [zero(len(states)), *([settled] if lags else [])]
    return [
        _column(combine((1 / stiffness, unit[-1]), (ONE, reading)))
        for environment in environments
        for _, stiffness in environment.stiffness.ends
        for reading in sensed
    ]


def _row(form: LinearForm) -> RationalMatrix:
    return RationalMatrix.from_rows([form])


def _column(form: LinearForm) -> RationalMatrix:
    return RationalMatrix.from_rows([[entry] for entry in form])
