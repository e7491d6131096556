"""Close the loop around every contact: the modes of one robot axis, in one state.

One mode for each controller and each corner of the box of the parameters of each environment that
it may touch. Every entry of A is affine in stiffness and in damping (or in one over it, as the law
of the environment says), and where the motor has ranges in its gain and in one over its time
constant, each for itself, so A is a convex combination of the corners in the whole box, and what
decreases in the corners decreases there, however fast the parameters move.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from itertools import permutations, product

from nrs_design.controllers.controller_design import Controller
from nrs_design.errors import AssemblyError
from nrs_design.loop.constraints import assemble_switching, leaving_impedance, zeroing
from nrs_design.loop.continuous_assumptions import assume_loop
from nrs_design.loop.free_motion import (
    adds_free_motion,
    flights_of,
    free_modes,
    lost_contact,
    outputs_of,
    pulls_of,
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
from nrs_design.loop.shared_state import SharedState
from nrs_design.models.contact.environment import Environment
from nrs_design.models.linear_form import coordinates
from nrs_design.models.motion_loop import JointMotionLoop, Realization
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.channels import Channel
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import SwitchingSpec
from nrs_design.spec.build_plant import Bounds


def close_loop(
    name: str,
    state: SharedState,
    rules: SwitchingSpec | None = None,
    contact: str | None = None,
    constants: Sequence[ConstantParameter] = (),
    *,
    limited: bool = False,
) -> tuple[SwitchedSystem, Sequence[LocatedMode]]:
    """Assemble every mode of an interaction design.

    Without rules any controller may follow any other at any time. Contact, losable or kept, may by
    default be lost where that is modelled, and a statement says whether it covers it. `limited`:
    some statement is about signals that saturate. An `AssemblyError` if contact may be lost, and
    that is not modelled.
    """
    rules, controllers = rules or SwitchingSpec(), state.design.controllers
    sprung = any(controller.law.spring for controller in controllers)
    free = sprung and adds_free_motion(state, contact, rules)
    losable = None if sprung or contact == "kept" else lost_contact(state, contact)
    items: list[LocatedMode] = []
    groups: dict[str, dict[str, None]] = {}
    for c in controllers:
        own = [*_in_contact(c, state, constants, by_contact=rules.names_contacts)]
        own += free_modes(c, state, constants) if free else ()
        groups[c.name] = dict.fromkeys(item.group for item in own)
        items += own
    pulls = tuple(pulls_of(state)) if free else ()
    system = SwitchedSystem(
        name=name,
        time=Time.CONTINUOUS,
        states=state.names,
        modes=tuple(item.mode for item in items),
        assumptions=tuple(
            assume_loop(state, rules, losable=losable is not None, free=free, limited=limited)
        ),
        switching=assemble_switching(rules, grouped(items), _resets(state, groups)),
        contact=losable,
        flights=flights_of(items, state.environments, pulls) if free else None,
        enclosures=tuple(enclosures_of(items)),
    )
    return system, items


def _resets(
    state: SharedState, groups: Mapping[str, Iterable[str]]
) -> Iterator[tuple[str, str, RationalMatrix]]:
    """Yield the switches that set states to zero, and the maps, by the groups of a controller.

    From an impedance controller to others the idle states are, if the spec says so; where force
    control takes the measured position, the lead is.
    """
    controllers = state.design.controllers
    switches: Iterable[tuple[str, str]] = ()
    if state.offset == "measured":
        switches = permutations((c.name for c in controllers), 2)
    elif state.idle is not None and state.idle.reset:
        switches = leaving_impedance(controllers)
    zeroed = state.names[-1:] if state.offset == "measured" else state.beside
    map_ = zeroing(state.names, zeroed)
    for source, target in switches:
        yield from ((*pair, map_) for pair in product(groups[source], groups[target]))


def _in_contact(
    controller: Controller,
    state: SharedState,
    constants: Sequence[ConstantParameter],
    *,
    by_contact: bool,
) -> Iterator[LocatedMode]:
    """Yield the modes of a controller in all its contacts, or in none if it takes no force."""
    by_name = {environment.name: environment for environment in state.environments}
    touched: list[Environment | None] = [by_name[name] for name in controller.contacts]
    if not touched:
        # A law without force feedback has the same mode in every contact, unless the plant differs.
        touched = [None, *(state.environments if state.feels else ())]
    for e in touched:
        where = () if e is None else (e.name,)
        name = "/".join((controller.name, *where))
        box, known = state.contact_box(e).beside(state.motor_box), (None, *where)
        # Dependent stiffness and damping do not attain every corner.
        real = state.motor_box.ranges if e is not None and e.depends else box.ranges
        own = [constant for constant in constants if constant.contact in known]
        for labels, rows in box.corners(partial(state.rows, controller.law, e), name):
            yield LocatedMode(
                name if by_contact else controller.name,
                Spot.named(controller.name, *where) + spot_of(labels, real, own),
                "" if e is None else e.name,
                Period(rows),
            )


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
        assumptions=(*system.assumptions, Assumption("inputs.command")),
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
