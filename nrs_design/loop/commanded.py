"""Effect of a bounded velocity command on an impedance design in continuous time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from nrs_design.errors import AssemblyError
from nrs_design.loop.free_motion import outputs_of
from nrs_design.loop.shared_state import SharedState
from nrs_design.models.contact.environment import Environment
from nrs_design.models.linear_form import coordinates
from nrs_design.models.motion_loop import JointMotionLoop, Realization
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.channels import Channel
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec.build_plant import Bounds

_ASSUMED = Assumption("inputs.command")


def with_command(
    system: SwitchedSystem, state: SharedState, disturbances: Bounds, torque: Fraction
) -> SwitchedSystem:
    """Let the largest velocity command act on a loop, with force and velocity as its outputs.

    The command goes where the velocity of the admittance is subtracted, into the motion loop, in
    contact and free alike. `torque` is the limit of the contact force about the pivot, in N m. An
    `AssemblyError` if it is not modelled for these controllers or environments.
    """
    laws = {controller.name: controller.law for controller in state.design.controllers}
    plain = all(law.commands == "velocity" for law in laws.values())
    if not plain or not state.environments:
        raise AssemblyError(
            "a velocity command is modelled for impedance controllers that touch something",
            remedy="leave disturbances out",
            at=("disturbances",),
        )
    sprung = next((name for name, law in laws.items() if law.spring), None)
    if sprung is not None:
        raise AssemblyError(
            "a velocity command moves the position that the spring Kt draws the robot to",
            remedy="leave command out, or Kt",
            at=("controllers", sprung, "Kt"),
        )
    ((name, (bound, unit)),) = disturbances.items()
    free = () if system.contact is None else system.contact.free
    columns = tuple(_column(mode, state.motion) for mode in (*system.modes, *free))
    velocity = state.motion.output(system.order)
    return replace(
        system,
        assumptions=(*system.assumptions, _ASSUMED),
        channels=(Channel(name, unit, bound, columns),),
        outputs=outputs_of(velocity, system.states, state.environments, torque),
    )


def check_memory(environments: Sequence[Environment]) -> None:
    """Refuse tissue that creeps, for which no bound under a command is stated."""
    if any(environment.law.remembers for environment in environments):
        raise AssemblyError(
            "a bound under a velocity command is stated on elastic and damped environments",
            remedy="leave disturbances out",
            at=("disturbances",),
        )


def _column(mode: Mode, motion: Realization | JointMotionLoop) -> RationalMatrix:
    """Return the input matrix of the velocity command in a mode, with the motor of its corner."""
    n = len(mode.A.numerators)
    if isinstance(motion, JointMotionLoop):
        # The error drives the motor by Km Kp/tau, a command by Km Kd/tau.
        drive = Fraction(mode.A.numerators[1][0], mode.A.denominator) / motion.Kp
        column = [[Fraction(1)], [drive * motion.Kd]]
    else:
        column = [[row[-1]] for row in motion.rates(coordinates(n + 1)[-1])]
    return RationalMatrix.from_rows([*column, *([Fraction(0)] for _ in range(n - motion.order))])
