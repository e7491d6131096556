"""Close the loop around every contact: the modes of one robot axis, in one state.

While another environment is touched, the memory of an environment decays as it does without force.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import chain

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.gains import idle_decay
from nrs_design.controllers.laws import CompliantLaw
from nrs_design.controllers.sensor import LowPass
from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.contact.kelvin_voigt import KelvinVoigt
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.models.linear_form import coordinates
from nrs_design.models.motion_loop import JointMotion, MotionLoop, Realization, realize
from nrs_design.models.plant import Plant
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.system import Contact, Mode, SwitchedSystem, Time
from nrs_design.spec import IdleStatesSpec, SwitchingSpec
from nrs_design.spec.controllers import Offset
from nrs_design.spec.interval import Interval
from nrs_design.switched.constraints import assemble_switching
from nrs_design.switched.gain_box import GainBox
from nrs_design.switched.joint import Joint
from nrs_design.switched.loop_assumptions import Assumed, assume_loop
from nrs_design.switched.mixture import check_mixture, resets_of
from nrs_design.switched.modes import (
    Rows,
    position_mode,
    to_force_coordinates,
    velocity_mode,
    with_idle,
    with_memories,
)
from nrs_design.switched.offset import names_of, retaken, to_motion
from nrs_design.switched.parameter_box import Box
from nrs_design.switched.parameters import Corner

# What impedance controllers in a mixture integrate their velocity to.
REFERENCE = "reference [rad]"


def close_loop(
    name: str,
    plant: Plant,
    loop: MotionLoop,
    design: ControllerDesign,
    coordinates: str,
    rules: SwitchingSpec | None = None,
    boxes: Mapping[str, GainBox] | None = None,
    idle: IdleStatesSpec | None = None,
    contact: str | None = None,
    offset: Offset = "none",
) -> SwitchedSystem:
    """Assemble every mode of an interaction design.

    One mode for each controller and each corner of the box of its gains and of the parameters of
    each environment that it may touch. Every entry of A is affine in stiffness, in damping (or in
    one over it, as the law of the environment says) and in the gains (or in one over them, as the
    law of the controller says), and where the motor has ranges in its gain and in one over its time
    constant, each for itself, so A is a convex combination of the corners in
    the whole box, and what decreases in the corners decreases there, however fast the parameters
    move.

    Parameters
    ----------
    name : str
        Name of the spec.
    plant : Plant
        Environments.
    loop : MotionLoop
        Closed motion loop G.
    design : ControllerDesign
        Gains that ship.
    coordinates : {"deflection", "force"}
        Last state of an impedance mode: the deflection (continuous when the stiffness changes
        in contact, so the physical choice) or the force (the thesis's choice).
    rules : SwitchingSpec, optional
        Rules for the change of controllers; by default any may follow any other at any time.
    boxes : mapping, optional
        Where the gains of controllers may be, by name; by default, at what ships.
    idle : IdleStatesSpec, optional
        What the states of impedance controllers do while another kind of controller is active; by
        default there is one kind only.
    contact : {"losable", "kept"}, optional
        Whether contact may be lost; by default it is where that is modelled, and a statement says
        whether it covers it.
    offset : {"none", "reference", "measured"}
        Where force controllers take their offset from; only where none commands a velocity.

    Raises
    ------
    AssemblyError
        If the modes do not share one state, or the coordinates do not apply.
    """
    rules = rules or SwitchingSpec()
    boxes = {c.name: GainBox.point(c.law) for c in design.controllers} | {**(boxes or {})}
    state = _shared_state(plant, loop, design, coordinates, idle, offset)
    sprung = any(controller.law.spring for controller in design.controllers)
    free = sprung and _adds_free_motion(state, design, contact)
    if free:
        _check_rules_of_flight(rules)
    losable = None if sprung or contact == "kept" else _lost_contact(state, design, boxes, contact)
    parts = {
        controller.name: (
            *_controller_modes(controller, plant, state, boxes[controller.name]),
            *(_free_modes(controller, state, boxes[controller.name]) if free else ()),
        )
        for controller in design.controllers
    }
    if rules.names_contacts:
        parts = _by_contact(chain.from_iterable(parts.values()))
    groups = {key: tuple(Corner(mode.name) for mode in part) for key, part in parts.items()}
    if idle is not None and idle.reset:
        resets = resets_of(design, state.realization.order, len(state.beside))
    else:
        resets = retaken(design, offset, state.realization.order)
    return SwitchedSystem(
        name,
        Time.CONTINUOUS,
        state.names,
        tuple(chain.from_iterable(parts.values())),
        assume_loop(
            Assumed(
                design,
                state.touched,
                boxes,
                coordinates,
                rules,
                idle,
                state.law,
                given=loop.given,
                losable=losable is not None,
                offset=offset,
                free=free,
                joint=state.joint,
            )
        ),
        assemble_switching(rules, groups, resets),
        losable,
    )


def _check_rules_of_flight(rules: SwitchingSpec) -> None:
    """Refuse rules that would forbid free motion to come and go while a controller is active."""
    if rules.names_contacts or next(rules.dwell_times(), None) is not None:
        raise AssemblyError(
            "where an admittance has a spring Kt, free motion is a mode like others, and contact "
            "is lost whatever the rules of switching say",
            remedy="use `contact: kept`, or rules with transitions between controllers alone",
            at=("switching",),
        )


def _by_contact(modes: Iterable[Mode]) -> dict[str, tuple[Mode, ...]]:
    """Return the modes by controller and contact, such as ``tissue/soft``, with all corners."""
    found: dict[str, tuple[Mode, ...]] = {}
    for mode in modes:
        name = "/".join(mode.name.split("/")[:2])
        found[name] = (*found.get(name, ()), mode)
    return found


def _shared_state(
    plant: Plant,
    loop: MotionLoop,
    design: ControllerDesign,
    coordinates: str,
    idle: IdleStatesSpec | None,
    offset: Offset,
) -> _State:
    touched = plant.among(design.contacts)
    _check_coordinates(coordinates, touched)
    _check_spring(coordinates, touched, design)
    if idle is not None:
        check_mixture(coordinates, touched)
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
    return _State(
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


@dataclass(frozen=True, slots=True)
class _State:
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
    def motion(self) -> Realization | JointMotion:
        """The motion loop at its nominal values."""
        return self.realization if self.joint is None else self.joint.nominal

    @property
    def motor_box(self) -> Box:
        """Where the motor may be."""
        return Box({}) if self.joint is None else self.joint.box

    def motion_at(self, values: Mapping[str, Fraction]) -> Realization | JointMotion:
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
            return names_of(self.realization.order)
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
        """Return A at the given gains of the law and parameters of the contact."""
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
        """Return a mode with the idle states that it leaves alone, or in coordinates of motion."""
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


def _controller_modes(
    controller: Controller, plant: Plant, state: _State, gains: GainBox
) -> Iterator[Mode]:
    law = controller.law
    if not controller.contacts:
        yield Mode(controller.name, RationalMatrix.from_rows(state.placed(law)))
    for environment in map(plant.environment, controller.contacts):
        name = f"{controller.name}/{environment.name}"
        box = state.contact_box(environment).beside(gains.box).beside(state.motor_box)
        for corner, rows in box.corners(partial(state.rows, law, environment), name):
            yield Mode(corner, RationalMatrix.from_rows(rows))


# What is touched where nothing is.
NOTHING = KelvinVoigt(Fraction(0), Fraction(0))


def _lost_contact(
    state: _State,
    design: ControllerDesign,
    boxes: Mapping[str, GainBox],
    contact: str | None,
) -> Contact | None:
    """Return how contact is lost, or None where that is not modelled.

    Raises
    ------
    AssemblyError
        If it is not modelled, and the spec asks for it.
    """
    damped = [e for e in state.touched if "b" in e.parameters]
    if not _can_be_free(state):
        if contact == "losable":
            raise _not_losable("")
        return None
    free = [mode for c in design.controllers for mode in _free_modes(c, state, boxes[c.name])]
    pulls = (_force_row(state, law) for environment in damped for law in environment.corners)
    return Contact(tuple(free), tuple(pulls), required=contact == "losable")


def _adds_free_motion(state: _State, design: ControllerDesign, contact: str | None) -> bool:
    """Tell whether free motion is one of the modes: with springs, it ends at rest in one place.

    That contact is lost at any deflection is more than happens, and is covered on demand only.

    Raises
    ------
    AssemblyError
        If it is not modelled, and the spec asks for it.
    """
    everywhere = all(controller.law.spring for controller in design.controllers)
    if contact == "losable" and not everywhere:
        raise _not_losable(", where some controllers have a spring Kt, for all that have one")
    if contact == "losable" and not _can_be_free(state):
        raise _not_losable("")
    return contact == "losable"


def _can_be_free(state: _State) -> bool:
    return (
        state.idle is None
        and state.law.commands == "velocity"
        and state.coordinates == "deflection"
        and not any(e.law.remembers or e.law.has_mass or e.preloaded for e in state.touched)
        and not any(e.parts and not e.each_losable for e in state.touched)
        and bool(state.touched)
    )


def _not_losable(which: str) -> AssemblyError:
    return AssemblyError(
        "loss of contact is modelled for impedance controllers on elastic and damped environments "
        f"in deflection coordinates{which}",
        remedy="use `contact: kept`",
        at=("contact",),
    )


def _free_modes(controller: Controller, state: _State, gains: GainBox) -> Iterator[Mode]:
    box, rows_at = gains.box.beside(state.motor_box), partial(_free_rows, state, controller.law)
    for corner, rows in box.corners(rows_at, f"{controller.name}/free"):
        yield Mode(corner, RationalMatrix.from_rows(rows))


def _free_rows(state: _State, law: CompliantLaw, values: Mapping[str, Fraction]) -> Rows:
    return velocity_mode(state.motion_at(values), law.of(values), NOTHING, state.low_pass)


def _force_row(state: _State, law: AbstractLinearLaw) -> RationalMatrix:
    """Return the force of a damped spring as a row on the states."""
    own = coordinates(len(state.names))
    force, _ = law.react(state.motion.output(len(own)), own[-1:])
    return RationalMatrix.from_rows([force])
