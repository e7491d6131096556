"""What a bounded velocity command does to the loop of an impedance design in continuous time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.linear_form import coordinates
from nrs_design.models.motion_loop import JointMotionLoop, MotionLoop, Realization, realize
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.sampling import DisturbancesSpec
from nrs_design.switched.assumption_kinds import INPUTS
from nrs_design.switched.joint import Joint

_ASSUMED = INPUTS.says(
    "A velocity command acts where a statement names it; it may change arbitrarily fast within its "
    "bound."
)


def with_command(
    system: SwitchedSystem,
    spec: InteractionDesignSpec,
    disturbances: DisturbancesSpec,
    loop: MotionLoop,
    joint: Joint | None,
    touched: Sequence[Environment],
) -> SwitchedSystem:
    """Let the largest velocity command act on a loop, with force and velocity as its outputs.

    The command goes where the velocity of the admittance is subtracted, into the motion loop, in
    contact and free alike.

    Parameters
    ----------
    system : SwitchedSystem
        The loop without inputs, in deflection coordinates.
    spec : InteractionDesignSpec
        With the limit of the torque.
    disturbances : DisturbancesSpec
        Of the spec.
    loop : MotionLoop
        Closed motion loop G.
    joint : Joint or None
        The motor in its physical state, where it has ranges or a load.
    touched : sequence of Environment
        All contacts.

    Raises
    ------
    AssemblyError
        If it is not modelled for these controllers, environments or coordinates.
    """
    plain = all(controller.commands == "velocity" for controller in spec.controllers.values())
    if not plain or spec.coordinates != "deflection" or not touched:
        raise AssemblyError(
            "a velocity command is modelled for impedance controllers that touch something, in "
            "deflection coordinates",
            remedy="leave disturbances out",
            at=("disturbances",),
        )
    sprung = next((name for name, c in spec.controllers.items() if "Kt" in c.gains()), None)
    if sprung is not None:
        raise AssemblyError(
            "a velocity command moves the position that the spring Kt draws the robot to",
            remedy="leave command out, or Kt",
            at=("controllers", sprung, "Kt"),
        )
    motion = realize(loop) if joint is None else joint.nominal
    free = () if system.contact is None else system.contact.free
    columns = tuple(_column(mode, motion) for mode in (*system.modes, *free))
    ((name, (bound, unit)),) = disturbances.bounds().items()
    return replace(
        system,
        assumptions=(*system.assumptions, _ASSUMED),
        channels=(Channel(name, unit, bound, columns),),
        outputs=outputs_of(system.states, motion, spec, touched),
    )


def check_memory(touched: Sequence[Environment]) -> None:
    """Refuse tissue that creeps, for which no bound under a command is stated.

    Parameters
    ----------
    touched : sequence of Environment
        All contacts.

    Raises
    ------
    AssemblyError
        If one of them remembers.
    """
    if any(environment.law.remembers for environment in touched):
        raise AssemblyError(
            "a bound under a velocity command is stated on elastic and damped environments",
            remedy="leave disturbances out",
            at=("disturbances",),
        )


def outputs_of(
    states: Sequence[str],
    motion: Realization | JointMotionLoop,
    spec: InteractionDesignSpec,
    touched: Sequence[Environment],
) -> tuple[Output, Output]:
    """Return force and velocity of a loop in contact.

    Parameters
    ----------
    states : sequence of str
        Names of the states.
    motion : Realization or JointMotionLoop
        The motion loop, whose states come first.
    spec : InteractionDesignSpec
        With the limit of the torque.
    touched : sequence of Environment
        All contacts: the force has a row for each of their corners.
    """
    return (
        Output(
            "force", "N*m", tuple(force_rows(motion, states, touched)), spec.limits.torque.exact
        ),
        Output("velocity", "rad/s", (RationalMatrix.from_rows([motion.output(len(states))]),)),
    )


def _column(mode: Mode, motion: Realization | JointMotionLoop) -> RationalMatrix:
    """Return what a commanded velocity does to a mode; the motor is the one of its corner."""
    n = len(mode.A.numerators)
    if isinstance(motion, JointMotionLoop):
        # The error drives the motor by Km Kp/tau, a command by Km Kd/tau.
        drive = Fraction(mode.A.numerators[1][0], mode.A.denominator) / motion.Kp
        column = [[Fraction(1)], [drive * motion.Kd]]
    else:
        column = [[row[-1]] for row in motion.rates(coordinates(n + 1)[-1])]
    return RationalMatrix.from_rows([*column, *([Fraction(0)] for _ in range(n - motion.order))])


def force_rows(
    motion: Realization | JointMotionLoop, states: Sequence[str], touched: Sequence[Environment]
) -> Iterator[RationalMatrix]:
    """Yield the force, as a row over the states, of each corner of each contact.

    Parameters
    ----------
    motion : Realization or JointMotionLoop
        The motion loop, whose states come first.
    states : sequence of str
        Names of the states.
    touched : sequence of Environment
        All contacts.
    """
    unit = coordinates(len(states))
    for environment in touched:
        shared, *memories = environment.law.states
        names = [shared, *(f"{environment.name}: {memory}" for memory in memories)]
        own = [unit[states.index(name)] for name in names]
        for law in environment.corners:
            force, _ = law.react(motion.output(len(states)), own)
            yield RationalMatrix.from_rows([force])
