"""The state that all modes of one robot axis share, and the rows of a mode in it.

The memory of an environment that is not touched decays as it does without force.

Impedance controllers may stand beside position and force controllers. These give the motion loop a
position; impedance controllers give it a velocity, which the robot integrates to a position
``r' = vc - vm``. With the states xi of the same loop G every mode is written in ``[xi, vm, r]``
(without virtual inertia ``[xi, r]``): ``xi' = Ap xi + Bp r``, ``theta = Cp xi``. Where another
controller is active, vm and r are idle.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.controller_design import SHARED_STATES, ControllerDesign
from nrs_design.controllers.gains import idle_decay
from nrs_design.controllers.laws import CompliantLaw
from nrs_design.controllers.sensor import LowPass
from nrs_design.errors import AssemblyError
from nrs_design.loop.modes import Rows, add_idle, lead, position_mode, replace_last, velocity_mode
from nrs_design.loop.parameter_box import Box, Joint
from nrs_design.models.contact.environment import Environment
from nrs_design.models.linear_form import ZERO
from nrs_design.models.motion_loop import JointMotionLoop, LoadedMotionLoop, Realization, realize
from nrs_design.models.plant import Plant
from nrs_design.spec import IdleStatesSpec
from nrs_design.spec.build_plant import OperatingConditions
from nrs_design.spec.controllers import Offset

# The integral of the velocity of impedance controllers in a mixture.
REFERENCE = "reference [rad]"


@dataclass(frozen=True, slots=True)
class SharedState:
    """All controllers of an axis in one state."""

    design: ControllerDesign  # Gains that ship
    environments: tuple[Environment, ...]
    realization: Realization  # The motion loop
    is_stated: bool  # Whether the spec states the motion loop
    joint: Joint | None  # The motion loop in physical states, where its motor has ranges or a load
    law: CompliantLaw  # Whose states the modes share
    # Rule for idle states, if the spec has one
    idle: IdleStatesSpec | None = None
    offset: Offset = "none"  # Source of the offset of force controllers
    bleeding: tuple[str, ...] = ()  # States of an integral that bleeds

    @property
    def low_pass(self) -> LowPass | None:
        """The filter of the force."""
        return self.design.sensor.filter

    @property
    def motion(self) -> Realization | JointMotionLoop:
        """The motion loop at its nominal values."""
        return self.realization if self.joint is None else self.joint.nominal

    @property
    def position_loop(self) -> Realization | LoadedMotionLoop:
        """The motion loop from position to position; its motor has no ranges."""
        return self.realization if self.joint is None else self.joint.nominal.position_loop

    @property
    def motor_box(self) -> Box:
        """Where the motor may be."""
        return Box({}) if self.joint is None else self.joint.box

    def find_motion(self, values: Mapping[str, Fraction]) -> Realization | JointMotionLoop:
        """Return the motion loop at the values of the motor."""
        return self.realization if self.joint is None else self.joint.evaluate(values)

    @property
    def memories(self) -> tuple[Environment, ...]:
        """The environments that have a memory of their own."""
        return tuple(e for e in self.environments if e.memory_rates is not None)

    @property
    def mixed_states(self) -> tuple[str, ...]:
        """States of the laws in a mixture of controllers."""
        moving = (*self.law.states, REFERENCE) if self.law.commands == "velocity" else ()
        return (*moving, *self.bleeding)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the states, with units where there are any."""
        order = self.realization.order
        if self.offset != "none":
            return (*(f"dxp{i + 1}" for i in range(order - 1)), "lead [rad]")
        memories = (f"{e.name}: {name}" for e in self.environments for name in e.law.states[1:])
        sensed = () if self.low_pass is None else self.low_pass.states
        # The deflection: continuous when the stiffness changes in contact.
        contact = () if self.is_placed else self.environments[0].law.states[:1]
        law_states = self.mixed_states if self.idle is not None else self.law.states
        moving = self.position_loop.states if self.is_placed else self.motion.states
        if self.idle is not None and self.joint is None:
            moving = tuple(f"xi{i + 1}" for i in range(order))
        return (*moving, *law_states, *sensed, *contact, *memories)

    @property
    def is_placed(self) -> bool:
        """Whether the motion loop is given positions, from which the deflection follows."""
        return self.idle is not None or self.law.commands == "position"

    @property
    def feels(self) -> bool:
        """Whether contacts differ for a controller that takes no force."""
        return self.joint is not None or self.low_pass is not None or bool(self.memories)

    def contact_box(self, environment: Environment | None) -> Box:
        """Return the parameters of a contact, and the rates of the memories that it leaves alone.

        A rate is a ratio of parameters, but they occur nowhere else in this mode: it is one axis.
        """
        creeps = {
            _rate(other): other.memory_rates[0]
            for other in self.memories
            if other != environment and other.memory_rates is not None
        }
        if environment is None:
            return Box(creeps)
        return Box(environment.parameters, environment.law.inverse).join(Box(creeps))

    def rows(
        self, law: CompliantLaw, environment: Environment | None, values: Mapping[str, Fraction]
    ) -> Rows:
        """Return A under a law at the given parameters of the contact; None touches nothing.

        States that others leave alone decay, and so do memories of what is not touched.
        """
        contact = None if environment is None else environment.evaluate(values)
        others = self.bleeding if self.idle is not None and not law.is_leaky else ()
        decay = ZERO if self.idle is None else idle_decay(self.idle)
        if self.is_placed:
            bleeding = decay if others else None
            rows = position_mode(self.position_loop, law, contact, self.low_pass, bleeding)
        else:
            assert contact is not None
            rows = velocity_mode(self.find_motion(values), law, contact, self.low_pass)
        if self.offset != "none":
            return replace_last(rows, lead(self.realization))
        integrated = (REFERENCE,) if law.commands == "velocity" else ()
        active = (*law.states, *integrated, *others)
        outer = self.mixed_states if self.idle is not None else ()
        idle = {self.names.index(name): decay for name in outer if name not in active}
        first = len(self.names) - len(self.memories)
        memories = enumerate(self.memories, first)
        return add_idle(rows, idle | {i: values[_rate(e)] for i, e in memories if e != environment})


def _rate(environment: Environment) -> str:
    return f"r-{environment.name}"


def shared_state(
    conditions: OperatingConditions, plant: Plant, design: ControllerDesign
) -> SharedState:
    """Return the shared state of the modes of a design; an `AssemblyError` if they share none."""
    laws, idle = [controller.law for controller in design.controllers], conditions.idle
    loop = plant.motion_loop(design.motion.Kp, design.motion.Kd)
    state = SharedState(
        design,
        plant.select_environments(design.contacts),
        realize(loop),
        loop.is_stated,
        Joint.from_plant(plant, design.motion),
        design.leading_laws(is_mixture=idle is not None)[0],
        idle,
        conditions.offset,
        next((law.states for law in laws if law.is_leaky), ()),
    )
    if (fault := next(_faults(state), None)) is not None:
        raise fault
    return state


def _faults(state: SharedState) -> Iterator[AssemblyError]:
    """Yield the reasons why the modes share no state."""
    controllers = state.design.controllers
    restless = [e for e in state.environments if not e.law.has_rest]
    for environment in restless:
        path = ("environments", environment.name)
        fault = f"environment {environment.name} has no rest position ({environment.law.name}), "
        if state.is_placed:
            yield AssemblyError(
                f"{fault}from which positions of position and force controllers count",
                remedy="use another environment, or impedance controllers alone",
                at=path,
            )
        if len(state.environments) > 1:
            yield AssemblyError(
                f"{fault}so it shares no deflection with another environment",
                remedy="let the controllers touch no other environment, or write a spec for each",
                at=path,
            )
    sprung = next((c.name for c in controllers if c.law.spring), None)
    if sprung is not None and restless:
        # The state does not tell the displacement of the spring.
        yield AssemblyError(
            f"an admittance with a spring Kt is not modelled in contact with {restless[0].name}, "
            f"which has no rest position ({restless[0].law.name})",
            remedy="leave Kt out, or give the environment a law that has a rest position",
            at=("controllers", sprung, "Kt"),
        )
    if (odd := state.design.find_odd_states(is_mixture=state.idle is not None)) is not None:
        yield AssemblyError(
            f"{odd}, so their modes share no state", remedy=SHARED_STATES, at=("controllers",)
        )
    if state.joint is not None and not state.joint.ranges.fixed and state.is_placed:
        yield AssemblyError(
            "ranges of the motor are modelled only for impedance controllers: at a switch to "
            "another controller, the speed jumps by unknown parameters of the motor",
            remedy="give nominal values of the actuator, or add sampling",
            at=("actuator",),
        )
