"""The state that all modes of one robot axis share, and the rows of a mode in it.

While another environment is touched, the memory of an environment decays as it does without force.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.controllers.gains import idle_decay
from nrs_design.controllers.laws import CompliantLaw
from nrs_design.controllers.sensor import LowPass
from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.models.motion_loop import JointMotionLoop, MotionLoop, Realization, realize
from nrs_design.models.plant import Plant
from nrs_design.spec import IdleStatesSpec
from nrs_design.spec.controllers import Offset
from nrs_design.spec.interval import Interval
from nrs_design.switched.joint import Joint
from nrs_design.switched.mixture import check_mixture_models
from nrs_design.switched.modes import (
    Rows,
    position_mode,
    to_force_coordinates,
    velocity_mode,
    with_idle,
    with_memories,
)
from nrs_design.switched.offset import state_names, to_motion
from nrs_design.switched.parameter_box import Box

# What impedance controllers in a mixture integrate their velocity to.
REFERENCE = "reference [rad]"


@dataclass(frozen=True, slots=True)
class SharedState:
    """What all modes share: motion loop, coordinates, contacts, states of the laws, idle ones.

    The motion loop is the realization, or the joint where its motor has ranges or a load.
    """

    realization: Realization
    coordinates: str
    touched: tuple[Environment, ...]
    law: CompliantLaw
    idle: IdleStatesSpec | None
    offset: Offset
    joint: Joint | None
    low_pass: LowPass | None
    bleeding: tuple[str, ...] = ()

    @property
    def motion(self) -> Realization | JointMotionLoop:
        """The motion loop at its nominal values."""
        return self.realization if self.joint is None else self.joint.nominal

    @property
    def motor_box(self) -> Box:
        """Where the motor may be."""
        return Box({}) if self.joint is None else self.joint.box

    def motion_at(self, values: Mapping[str, Fraction]) -> Realization | JointMotionLoop:
        """Return the motion loop at the values of the motor."""
        return self.realization if self.joint is None else self.joint.at(values)

    @property
    def memories(self) -> tuple[Environment, ...]:
        """The environments that have a memory of their own."""
        return tuple(e for e in self.touched if e.creep is not None)

    @property
    def beside(self) -> tuple[str, ...]:
        """In a mixture, the states beside those of the motion loop."""
        moving = (*self.law.states, REFERENCE) if self.law.commands == "velocity" else ()
        return (*moving, *self.bleeding)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the states, with units where there are any."""
        if self.offset != "none":
            return state_names(self.realization.order)
        inner = self.motion.states
        if self.idle is not None:
            inner = tuple(f"xi{i + 1}" for i in range(len(inner)))
        if self.idle is not None:
            return (*inner, *self.beside)
        loop = (*inner, *self.law.states)
        if self.law.commands == "position":
            return loop
        contact = "F [N*m]" if self.coordinates == "force" else self.touched[0].law.states[0]
        memories = (f"{e.name}: {name}" for e in self.touched for name in e.law.states[1:])
        sensed = () if self.low_pass is None else self.low_pass.states
        return (*loop, *sensed, contact, *memories)

    def contact_box(self, environment: Environment) -> Box:
        """Return the parameters of a contact, and the rates of the memories that it leaves alone.

        A rate is a ratio of parameters, but they occur nowhere else in this mode: it is one axis.
        """
        creeps: dict[str, Interval] = {
            _rate(other): other.creep
            for other in self.memories
            if other != environment and other.creep is not None
        }
        return Box(environment.parameters, environment.law.inverse).beside(Box(creeps))

    def rows(
        self, law: CompliantLaw, environment: Environment, values: Mapping[str, Fraction]
    ) -> Rows:
        """Return A at the given gains of the law and parameters of the contact.

        Parameters
        ----------
        law : CompliantLaw
            Of the controller.
        environment : Environment
            That is touched.
        values : mapping
            Gains, parameters of the contact, of the motor, and rates of memories, by name.
        """
        held, contact = law.of(values), environment.at(values)
        if self.idle is not None or law.commands == "position":
            return self.placed(held, contact, environment.name)
        rows = velocity_mode(self.motion_at(values), held, contact, self.low_pass)
        if self.coordinates == "force":
            return to_force_coordinates(rows, self.motion, contact)
        creeps = {
            e.name: Fraction(0) if e == environment else values[_rate(e)] for e in self.memories
        }
        touched = environment.name if environment in self.memories else None
        return with_memories(rows, touched, creeps)

    def placed(
        self, law: CompliantLaw, contact: AbstractLinearLaw | None = None, environment: str = ""
    ) -> Rows:
        """Return a mode with the idle states that it leaves alone, or in coordinates of motion.

        Parameters
        ----------
        law : CompliantLaw
            Of the controller.
        contact : AbstractLinearLaw, optional
            What is touched; by default nothing.
        environment : str
            Its name.
        """
        others = self.bleeding if self.idle is not None and not law.bleeds else ()
        decay = Fraction(0) if self.idle is None else idle_decay(self.idle)
        bleeding = decay if others else None
        rows = position_mode(self.realization, law, contact, environment, bleeding)
        if self.offset != "none":
            return to_motion(rows, self.realization)
        if self.idle is None:
            return rows
        integrated = (REFERENCE,) if law.commands == "velocity" else ()
        own = (*law.states, *integrated, *others)
        order = self.realization.order
        places = [*range(order), *(order + self.beside.index(name) for name in own)]
        return with_idle(rows, places, order + len(self.beside), decay)


def _rate(environment: Environment) -> str:
    return f"r-{environment.name}"


def shared_state(
    plant: Plant,
    loop: MotionLoop,
    design: ControllerDesign,
    coordinates: str,
    idle: IdleStatesSpec | None,
    offset: Offset,
) -> SharedState:
    """Return what the modes of an interaction design share.

    Parameters
    ----------
    plant : Plant
        Environments.
    loop : MotionLoop
        Closed motion loop G.
    design : ControllerDesign
        Gains that ship.
    coordinates, idle, offset
        As for `nrs_design.switched.close_loop.close_loop`.

    Raises
    ------
    AssemblyError
        If the modes do not share one state, or the coordinates do not apply.
    """
    touched = plant.among(design.contacts)
    _check_coordinates(coordinates, touched)
    _check_spring(coordinates, touched, design)
    if idle is not None:
        check_mixture_models(coordinates, touched)
    shared = _shared_law(design, mixed=idle is not None)
    joint = Joint.of(plant, design.motion)
    if joint is not None and (idle is not None or shared.commands != "velocity"):
        raise AssemblyError(
            "ranges of the motor, or its load, are modelled for impedance controllers alone",
            remedy="give nominal values of the actuator and no load_inertia",
            at=("actuator",),
        )
    low_pass = design.sensor.filter
    bleeding = next((c.law.states for c in design.controllers if c.law.bleeds), ())
    return SharedState(
        realize(loop), coordinates, touched, shared, idle, offset, joint, low_pass, bleeding
    )


def _check_coordinates(coordinates: str, touched: tuple[Environment, ...]) -> None:
    for environment in touched:
        law = environment.law
        if coordinates == "force" and law.remembers:
            raise AssemblyError(
                f"force coordinates do not apply to environment {environment.name}, which is "
                f"{law.name}",
                remedy="use coordinates: deflection",
                at=("coordinates",),
            )
        if not law.has_rest and len(touched) > 1:
            raise AssemblyError(
                f"environment {environment.name} has no rest position ({law.name}), so it shares "
                "no deflection with another environment",
                remedy="let the controllers touch no other environment, or write a spec for each",
                at=("environments", environment.name),
            )


def _check_spring(
    coordinates: str, touched: tuple[Environment, ...], design: ControllerDesign
) -> None:
    """Refuse a spring in an admittance where the state does not tell its displacement."""
    name = next((c.name for c in design.controllers if c.law.spring), None)
    if name is None:
        return
    at = ("controllers", name, "Kt")
    if coordinates == "force":
        raise AssemblyError(
            "force coordinates do not apply to an admittance with a spring Kt: where the "
            "deflection jumps, so would its displacement",
            remedy="use coordinates: deflection, or leave Kt out",
            at=at,
        )
    restless = next((e for e in touched if not e.law.has_rest), None)
    if restless is not None:
        raise AssemblyError(
            f"an admittance with a spring Kt is not modelled in contact with {restless.name}, "
            f"which has no rest position ({restless.law.name})",
            remedy="leave Kt out, or give the environment a law that has a rest position",
            at=at,
        )


def _shared_law(design: ControllerDesign, *, mixed: bool) -> CompliantLaw:
    """Return a law whose states are those that the modes share.

    In a mixture these are the states of the controllers that command a velocity, and of those whose
    integral bleeds; the others have none of their own.

    Raises
    ------
    AssemblyError
        If the states of the laws are not the same.
    """
    laws = [controller.law for controller in design.controllers]
    leading = laws
    if mixed:
        leading = [law for law in laws if law.commands == "velocity"] or [
            law for law in laws if law.bleeds
        ]
    kinds = {(law.commands, law.states) for law in leading}
    if mixed:
        kinds |= {(law.commands, law.states) for law in laws if law.states and not law.bleeds}
    if len(kinds) > 1:
        kept = [f"{law.name} with {', '.join(law.states) or 'no state'}" for law in laws]
        found = "; ".join(dict.fromkeys(kept))
        raise AssemblyError(
            f"the controllers keep different states of their own ({found}), so their modes share "
            "no state",
            remedy="give all impedance controllers a virtual inertia Mt > 0, or none of them; mix "
            "no parallel controllers with others",
            at=("controllers",),
        )
    return leading[0]
