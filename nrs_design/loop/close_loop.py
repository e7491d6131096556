"""Close the loop around every contact: the modes of one robot axis, in one state.

There is a mode for each controller and each corner of the parameters of motor and environment.
Every entry of A is affine in each of them, or in one over it. So A is a convex combination of the
corners in the whole box, and a function that decreases in the corners decreases there, however fast
the parameters move.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import permutations, product

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.errors import AssemblyError
from nrs_design.loop.constraints import assemble_switching, leaving_impedance, zeroing
from nrs_design.loop.free_motion import (
    Loss,
    could_pull,
    flights_of,
    force_rows,
    lost_on_surface,
    outputs_of,
)
from nrs_design.loop.located import (
    ConstantParameter,
    LocatedMode,
    Period,
    Spot,
    enclosures_of,
    grouped,
    spot_of,
)
from nrs_design.loop.loop_assumptions import assume_loop
from nrs_design.loop.saturation import add_saturation
from nrs_design.loop.shared_state import SharedState, shared_state
from nrs_design.models.contact.environment import Environment
from nrs_design.models.contact.kelvin_voigt import KelvinVoigt
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import ZERO, coordinates
from nrs_design.models.motion_loop import JointMotionLoop, Realization
from nrs_design.models.plant import Plant
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.channels import Channel
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import SwitchingSpec
from nrs_design.spec.build_plant import Bounds, OperatingConditions
from nrs_design.spec.interaction_parts import FREE

# Free motion, as an environment without force.
AIR = Environment(FREE, KelvinVoigt, (Interval.point(ZERO), Interval.point(ZERO)))


def close_loop(
    conditions: OperatingConditions,
    plant: Plant,
    design: ControllerDesign,
    constants: Sequence[ConstantParameter] = (),
) -> tuple[SwitchedSystem, Sequence[LocatedMode]]:
    """Return the system of a loop in continuous time, and its modes."""
    state, has_saturation = (
        shared_state(conditions, plant, design),
        conditions.initial_force is not None,
    )
    rules = conditions.switching
    loss = _loss_of(state, conditions.contact, rules)
    items: list[LocatedMode] = []
    free: list[LocatedMode] = []
    groups: dict[str, dict[str, None]] = {}
    for c in design.controllers:
        modes = [
            *_modes(c, state, _find_contacts(c, state), constants, by_contact=rules.names_contacts)
        ]
        air = [*_modes(c, state, [AIR], constants)] if loss is not Loss.NEVER else []
        modes += air if loss.anywhere else ()
        free += air
        groups[c.name] = dict.fromkeys(item.group for item in modes)
        items += modes
    losable, velocity = loss is Loss.SURFACE, state.motion.output(len(state.names))
    pulling = could_pull(state.environments) if free else ()
    tensions = tuple(force_rows(velocity, state.names, pulling))
    system = SwitchedSystem(
        name=conditions.name,
        time=Time.CONTINUOUS,
        states=state.names,
        modes=tuple(item.mode for item in items),
        assumptions=tuple(
            assume_loop(
                state, rules, losable=losable, free=loss.anywhere, has_saturation=has_saturation
            )
        ),
        switching=assemble_switching(rules, grouped(items), _resets(state, groups)),
        contact=lost_on_surface((item.mode for item in free), tensions, conditions.contact)
        if losable
        else None,
        flights=flights_of(items, state.environments, tensions) if loss.anywhere else None,
        enclosures=tuple(enclosures_of(items)),
    )
    if conditions.disturbances is not None:
        _check_memory(state.environments)
        system = add_command(system, state, conditions.disturbances, conditions.torque)
    return add_saturation(
        system, conditions, plant.actuator, state
    ) if has_saturation else system, items


def _loss_of(state: SharedState, contact: str | None, rules: SwitchingSpec) -> Loss:
    """Return how contact is lost, by the key `contact` of a spec; by default, where it is modelled.

    With springs, free motion ends at rest in one place, and is a mode on demand only: that contact
    is lost at any deflection is more than happens.
    """
    environments = state.environments
    sprung = {bool(c.law.spring) for c in state.design.controllers}
    loss = Loss.classify(contact, environments, state.design, slowed=False)
    modelled = (
        loss in (Loss.ANYWHERE, Loss.SURFACE)
        and bool(environments)
        and state.idle is None
        and not any(e.law.has_mass for e in environments)
    )
    if contact != "losable":
        return loss if modelled else Loss.NEVER
    if len(sprung) > 1:
        raise _not_losable(", where some controllers have a spring Kt, for all that have one")
    if not modelled:
        raise _not_losable("")
    if loss.anywhere and (rules.names_contacts or next(rules.dwell_times(), None) is not None):
        raise AssemblyError(
            "with a spring Kt, free motion is one of the modes, and rules of switching do not "
            "limit the loss of contact",
            remedy="use `contact: kept`, or rules with transitions between controllers alone",
            at=("switching",),
        )
    return loss


def _not_losable(detail: str) -> AssemblyError:
    return AssemblyError(
        "loss of contact is modelled for impedance controllers on elastic and damped environments"
        f"{detail}",
        remedy="use `contact: kept`",
        at=("contact",),
    )


def _resets(
    state: SharedState, groups: Mapping[str, Iterable[str]]
) -> Iterator[tuple[str, str, RationalMatrix]]:
    """Yield the switches at which idle states become zero, or the lead of a measured position."""
    controllers = state.design.controllers
    switches: Iterable[tuple[str, str]] = ()
    if state.offset == "measured":
        switches = permutations((c.name for c in controllers), 2)
    elif state.idle is not None and state.idle.reset:
        switches = leaving_impedance(controllers)
    zeroed = state.names[-1:] if state.offset == "measured" else state.mixed_states
    map_ = zeroing(state.names, zeroed)
    for source, target in switches:
        yield from ((*pair, map_) for pair in product(groups[source], groups[target]))


def _find_contacts(c: Controller, state: SharedState) -> Sequence[Environment | None]:
    """Return the contacts of a controller; None, and all that it feels, if it takes no force."""
    environments = {environment.name: environment for environment in state.environments}
    extra = state.environments if state.feels else ()
    return [environments[name] for name in c.contacts] or [None, *extra]


def _modes(
    c: Controller,
    state: SharedState,
    contacts: Iterable[Environment | None],
    constants: Sequence[ConstantParameter] = (),
    *,
    by_contact: bool = False,
) -> Iterator[LocatedMode]:
    """Yield the modes of a controller in some contacts, at every corner of contact and motor."""
    for e in contacts:
        place = () if e is None else (e.name,)
        name, known = "/".join((c.name, *place)), (None, *place)
        box = state.contact_box(e).join(state.motor_box)
        # Dependent stiffness and damping do not attain every corner.
        real = state.motor_box.ranges if e is not None and e.depends else box.ranges
        relevant = [constant for constant in constants if constant.contact in known]
        for labels, rows in box.corners(partial(state.rows, c.law, e), name):
            yield LocatedMode(
                name if by_contact else c.name,
                Spot.from_names(c.name, *place) + spot_of(labels, real, relevant),
                "".join(place),
                Period(rows),
            )


def add_command(
    system: SwitchedSystem, state: SharedState, disturbances: Bounds, torque: Fraction
) -> SwitchedSystem:
    """Let the largest velocity command act on a loop, with force and velocity as its outputs.

    The command enters the motion loop, where the velocity of the admittance is subtracted. `torque`
    is the limit of the contact force about the pivot, in N m.
    """
    laws = {controller.name: controller.law for controller in state.design.controllers}
    is_velocity = all(law.commands == "velocity" for law in laws.values())
    if not is_velocity or not state.environments:
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
    columns = tuple(_column(mode, state.motion) for mode in system.every_mode)
    velocity = state.motion.output(system.order)
    return replace(
        system,
        assumptions=(*system.assumptions, Assumption("inputs.command")),
        channels=(Channel(name, unit, bound, columns),),
        outputs=outputs_of(velocity, system.states, state.environments, torque),
    )


def _check_memory(environments: Sequence[Environment]) -> None:
    """Refuse tissue that creeps, for which no bound under a command is stated."""
    if any(environment.law.has_memory for environment in environments):
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
