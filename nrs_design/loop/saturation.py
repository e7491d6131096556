"""Saturating signals of a loop: the motor command, and in continuous time the velocity command.

In continuous time the admittance commands the velocity v. The motion loop integrates ``e' = sat(v)
- omega`` and commands the motor ``u = Kp e + Kd (sat(v) - omega)``, of which the driver takes
``sat(u)``: ``tau omega' = Km sat(u) - omega``, less what a load adds. The processor cuts off u; of
the velocities it cuts off what the hand commands.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from nrs_design.controllers.float32 import float32_not_above
from nrs_design.loop.located import LocatedMode
from nrs_design.loop.program import BEFORE, CUT_OFF, INPUTS
from nrs_design.loop.sampled import SampledLoop
from nrs_design.loop.shared_state import SharedState
from nrs_design.models.actuator import Actuator
from nrs_design.models.contact.environment import Environment
from nrs_design.models.linear_form import LinearForm, combine, coordinates, zero
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
_KEPT = "error of motion a sample ago"


def with_saturation(
    system: SwitchedSystem,
    conditions: OperatingConditions,
    actuator: Actuator,
    state: SharedState,
) -> SwitchedSystem:
    """Let a statement be about motions in which velocity command and motor command saturate.

    The motor is the nominal one; limits and goal are as `nrs_design.spec.combinations` checks.
    """
    assert conditions.largest_command is not None  # `combinations` asks for it.
    motion, low_pass = state.motion, state.low_pass
    drive = actuator.gain / actuator.time_constant
    n, free = system.order, () if system.contact is None else system.contact.free
    modes = (*system.modes, *free)
    error, omega, columns = _physical(motion, n)
    Kp, Kd = state.design.motion.Kp, state.design.motion.Kd
    motor = RationalMatrix.from_rows([[*combine((Kp, error), (-Kd, omega)), Kd]])
    drives = [_drive(mode, Kp) if state.joint is not None else drive for mode in modes]
    velocity_limit = float32_not_above(conditions.velocity)
    command_limit = float32_not_above(conditions.largest_command)
    signals = (
        CutOff(
            name="velocity command",
            unit=conditions.axis.unit("rad/s"),
            limit=velocity_limit,
            columns=(_column(columns[0]),) * len(modes),
            rows=tuple(RationalMatrix.from_rows([_command(mode, motion)]) for mode in modes),
        ),
        CutOff(
            name="motor command",
            unit=conditions.command,
            limit=command_limit,
            columns=tuple(_column([share * entry for entry in columns[1]]) for share in drives),
            rows=(motor,) * len(modes),
        ),
    )
    lags = () if low_pass is None else low_pass.states
    start = _start(conditions, _rest(system.states, state.environments, lags))
    limited = Assumption.create(
        "limited.signals",
        velocity=rounded_up(velocity_limit, conditions.axis.unit("rad/s")),
        command=rounded_up(command_limit, conditions.command),
        filtered=low_pass and "filter",
    )
    assumptions = (*system.assumptions, limited)
    return replace(system, saturation=Saturation(signals, start), assumptions=assumptions)


def with_sampled_saturation(
    system: SwitchedSystem,
    conditions: OperatingConditions,
    loop: SampledLoop,
    modes: Sequence[LocatedMode],
    environments: Sequence[Environment],
) -> SwitchedSystem:
    """Let a statement be about motions in which the command of the motor saturates, sampled.

    Modes of free motion are the last ones; limit and goal are as `nrs_design.spec.combinations`
    checks.
    """
    assert conditions.largest_command is not None  # `combinations` asks for it.
    n, wide = len(loop.states), len(loop.states) + len(INPUTS)
    limit, cut = float32_not_above(conditions.largest_command), INPUTS.index(CUT_OFF)
    signal = CutOff(
        name=MOTOR_COMMAND,
        unit=conditions.command,
        limit=limit,
        columns=tuple(mode.column(cut) for mode in modes),
        rows=tuple(RationalMatrix.from_rows([mode.period.command[:n]]) for mode in modes),
        errors=tuple(RationalMatrix.from_rows([mode.period.command[wide:]]) for mode in modes)
        if system.roundings
        else (),
    )
    signals = (signal, *_clamped(conditions, loop, modes, rounded=bool(system.roundings)))
    placed = any(law.law.commands == "position" for law in loop.program.laws)
    rest = _rest(system.states, environments, loop.shown_later)
    if placed:
        rest = list(_held(loop, modes, rest))
    integral = [rounded_up(other.limit, other.unit) for other in signals[1:]]
    limited = Assumption.create(
        "limited.sampled",
        command=rounded_up(limit, conditions.command),
        clamped=bool(integral) and "integral",
        integral=tuple(integral),
        filtered=bool(loop.shown_later) and "samples",
    )
    start = _start(conditions, rest, _KEPT if placed else "")
    return replace(
        system, saturation=Saturation(signals, start), assumptions=(*system.assumptions, limited)
    )


def _clamped(
    conditions: OperatingConditions,
    loop: SampledLoop,
    modes: Sequence[LocatedMode],
    *,
    rounded: bool,
) -> Iterator[CutOff]:
    """Yield the saturated integral of the force error."""
    if conditions.largest_integral is None:
        return
    n, wide = len(loop.states), len(loop.states) + len(INPUTS)
    k = loop.states.index(INTEGRAL)
    rows = [mode.period.moves[k] for mode in modes]
    yield CutOff(
        name="integral of the force error",
        unit=conditions.axis.unit("rad"),
        limit=float32_not_above(conditions.largest_integral),
        columns=(_column(coordinates(n)[k]),) * len(modes),
        # The integral does not depend on the saturated command.
        rows=tuple(RationalMatrix.from_rows([[*row[:n], Fraction(0)]]) for row in rows),
        errors=tuple(RationalMatrix.from_rows([row[wide:]]) for row in rows) if rounded else (),
    )


def _held(
    loop: SampledLoop, modes: Sequence[LocatedMode], states: Sequence[RationalMatrix]
) -> Iterator[RationalMatrix]:
    """Yield states at rest in which the error of a sample ago is that of now, in any mode.

    The command ``Kp e + D (e - e before)`` is ``(Kp + D) e`` where the error before is zero.
    """
    before, n = loop.states.index(loop.program.stored[BEFORE]), len(loop.states)
    gain = loop.program.step.Kp + loop.program.step.D
    commands = {tuple(mode.period.command[:n]) for mode in modes}
    found: dict[RationalMatrix, None] = {}
    for state in states:
        (x,) = zip(*state.fractions(), strict=True)
        for command in commands:
            error = sum((c * v for c, v in zip(command, x, strict=True)), Fraction(0)) / gain
            found[_column([*x[:before], error, *x[before + 1 :]])] = None
    yield from found


def _start(
    conditions: OperatingConditions, states: Iterable[RationalMatrix], beside: str = ""
) -> Start:
    wanted = conditions.initial_force
    return Start(
        "contact force",
        conditions.axis.unit("N*m"),
        tuple(states),
        None if isinstance(wanted, str) else wanted,
        beside,
    )


def _physical(
    motion: Realization | JointMotionLoop, n: int
) -> tuple[LinearForm, LinearForm, tuple[LinearForm, LinearForm]]:
    """Return e and omega as forms of the state, and the state change of a change in each."""
    omega, unit = motion.output(n), coordinates(n)
    error = unit[_ERROR] if isinstance(motion, JointMotionLoop) else motion.integral(zero(n))
    (a, b), (c, d) = error[:2], omega[:2]
    determinant = a * d - b * c
    rest = zero(n - 2)
    first = [d / determinant, -c / determinant, *rest]
    second = [-b / determinant, a / determinant, *rest]
    return error, omega, (first, second)


def _command(mode: Mode, motion: Realization | JointMotionLoop) -> LinearForm:
    """Return the velocity that the law commands in a mode: what drives its motion loop."""
    n, A = len(mode.A.numerators), mode.A.fractions()
    still = motion.rates(zero(n))
    k = _ERROR if isinstance(motion, JointMotionLoop) else motion.order - 1
    return combine((Fraction(1), A[k]), (Fraction(-1), still[k]))


def _drive(mode: Mode, Kp: Fraction) -> Fraction:
    """Return Km/tau of a mode in the physical state, where the error accelerates by Km Kp/tau."""
    return mode.A.fractions()[_OMEGA][_ERROR] / Kp


def _rest(
    states: Sequence[str], environments: Sequence[Environment], lags: Collection[str]
) -> list[RationalMatrix]:
    """Return the states at rest with a unit of force, at every stiffness.

    What shows the force later, such as a filter of it, may not have seen it yet, or have settled.
    """
    unit = coordinates(len(states))
    settled = [Fraction(int(state in lags)) for state in states]
    sensed = [zero(len(states)), *([settled] if lags else [])]
    return [
        _column(combine((1 / stiffness, unit[-1]), (Fraction(1), shown)))
        for environment in environments
        for _, stiffness in environment.stiffness.ends
        for shown in sensed
    ]


def _column(form: Sequence[Fraction]) -> RationalMatrix:
    return RationalMatrix.from_rows([[entry] for entry in form])
