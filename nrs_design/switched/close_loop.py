"""Close the loop around every contact: the modes of one robot axis, exactly.

State of an impedance mode: ``[xp, vm, delta]``, the motion loop, the admittance velocity (absent
with zero virtual inertia) and the deflection (of the spring alone in a Maxwell environment), and
behind them one more state for every touched environment that has one, a memory. While another
environment is touched, a memory decays as it does without force. State of a position or force
mode: ``xp`` alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import chain

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.gains import idle_decay
from nrs_design.controllers.laws import Admittance, PositionControl, ProportionalForce
from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.models.plant import Plant
from nrs_design.proof.matrix import RationalMatrix, multiply
from nrs_design.proof.system import Mode, SwitchedSystem, Time
from nrs_design.spec import IdleStatesSpec, SwitchingSpec
from nrs_design.switched.assumptions import CONTINUOUS, rule_texts
from nrs_design.switched.constraints import assemble_switching
from nrs_design.switched.gain_box import GainBox
from nrs_design.switched.mixture import (
    check_mixture,
    idle_size,
    impedance_rows,
    mixture_states,
    mixture_texts,
    resets_of,
    with_idle,
)
from nrs_design.switched.parameter_box import Axis, box_corners
from nrs_design.switched.parameters import Corner

Row = list[Fraction]


@dataclass(frozen=True, slots=True)
class Realization:
    """Controllable canonical form ``xp' = A xp + B u``, ``v = C xp`` with ``B = [0, ..., 1]'``."""

    A: tuple[tuple[Fraction, ...], ...]
    C: tuple[Fraction, ...]

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.C)


def realize(loop: MotionLoop) -> Realization:
    """Return the minimal realization of a strictly proper motion loop (thesis 6.13-6.14).

    Raises
    ------
    AssemblyError
        If the transfer function is not strictly proper.
    """
    n = len(loop.denominator) - 1
    leading = loop.denominator[0]
    if n < 1 or len(loop.numerator) > n or leading == 0:
        raise AssemblyError(
            "the motion loop is not strictly proper",
            remedy="its numerator must have a lower degree than its denominator",
        )
    last = tuple(-c / leading for c in reversed(loop.denominator[1:]))
    shift = tuple(tuple(Fraction(int(j == i + 1)) for j in range(n)) for i in range(n - 1))
    padding = (Fraction(0),) * (n - len(loop.numerator))
    return Realization(
        (*shift, last), tuple(c / leading for c in reversed(loop.numerator)) + padding
    )


def close_loop(
    name: str,
    plant: Plant,
    loop: MotionLoop,
    design: ControllerDesign,
    coordinates: str,
    rules: SwitchingSpec | None = None,
    boxes: Mapping[str, GainBox] | None = None,
    idle: IdleStatesSpec | None = None,
) -> SwitchedSystem:
    """Assemble every mode of an interaction design.

    One mode for each controller and each corner of the box of its gains and of the parameters of
    each environment that it may touch. Every entry of A is affine in stiffness, in damping (or in
    one over it, as the law of the environment says), in Bt and in 1/Mt (without inertia: in 1/Bt),
    each for itself, so A is a convex combination of the corners in the whole box, and what
    decreases in the corners decreases there, however fast the parameters move.

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
        Where the gains of impedance controllers may be, by name; by default, at what ships.
    idle : IdleStatesSpec, optional
        What the states of impedance controllers do while another kind of controller is active; by
        default there is one kind only.

    Raises
    ------
    AssemblyError
        If the modes do not share one state, or the coordinates do not apply.
    """
    motion = realize(loop)
    rules = rules or SwitchingSpec()
    boxes = boxes or {}
    touched = _touched(design, plant)
    _check_coordinates(coordinates, touched)
    count = 0
    if idle is not None:
        check_mixture(coordinates, touched)
        count = idle_size(design)
    memories = tuple(e for e in touched if e.creep is not None)
    parts = {
        controller.name: tuple(
            _controller_modes(
                controller,
                plant,
                _Surroundings(motion, coordinates, memories, idle, count),
                boxes.get(controller.name),
            )
        )
        for controller in design.controllers
    }
    modes = tuple(chain.from_iterable(parts.values()))
    sizes = sorted({mode.A.shape[0] for mode in modes})
    if len(sizes) != 1:
        raise AssemblyError(
            f"the modes have {' and '.join(map(str, sizes))} states, so they share no state",
            remedy="give all impedance controllers a virtual inertia Mt > 0, or none of them",
            at=("controllers",),
        )
    states = _state_names(motion.order, sizes[0], coordinates, touched)
    if idle is not None:
        states = mixture_states(motion.order, count)
    assumptions = _assumptions(design, coordinates, rules, boxes, touched, idle, given=loop.given)
    groups = {key: tuple(Corner(mode.name) for mode in part) for key, part in parts.items()}
    reset = idle is not None and idle.reset
    resets = resets_of(design, motion.order, count) if reset else ()
    switching = assemble_switching(rules, groups, resets)
    return SwitchedSystem(name, Time.CONTINUOUS, states, modes, assumptions, switching)


def _touched(design: ControllerDesign, plant: Plant) -> tuple[Environment, ...]:
    """Return what some controller touches, in the order of the spec."""
    names = {contact for controller in design.controllers for contact in controller.contacts}
    return tuple(environment for environment in plant.environments if environment.name in names)


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


@dataclass(frozen=True, slots=True)
class _Surroundings:
    """What all modes share: motion loop, coordinates, memories, idle states and their count."""

    motion: Realization
    coordinates: str
    memories: tuple[Environment, ...]
    idle: IdleStatesSpec | None
    count: int

    def padded(self, rows: list[Row]) -> list[Row]:
        """Return a mode of a position or force controller, with idle states if there are any."""
        return rows if self.idle is None else with_idle(rows, self.count, idle_decay(self.idle))


def _controller_modes(
    controller: Controller, plant: Plant, around: _Surroundings, box: GainBox | None
) -> Iterator[Mode]:
    law = controller.law
    if isinstance(law, PositionControl):
        alone = around.padded([list(row) for row in around.motion.A])
        yield Mode(controller.name, RationalMatrix.from_rows(alone))
        return
    gains: tuple[Axis, ...] = ()
    if isinstance(law, Admittance):
        gains = (box or GainBox.point(law)).axes
    for environment in map(plant.environment, controller.contacts):
        name = f"{controller.name}/{environment.name}"
        axes = (*_contact_axes(environment, around.memories), *gains)
        rows_at = partial(_rows_at, law, environment, around)
        for label, rows in box_corners(axes, rows_at, name):
            yield Mode(f"{name}/{label}" if label else name, RationalMatrix.from_rows(rows))


def _contact_axes(environment: Environment, memories: tuple[Environment, ...]) -> Iterator[Axis]:
    """Yield the parameters of a contact, and the rates of the memories that it leaves alone.

    A rate is a ratio of parameters, but they occur nowhere else in this mode: it is one axis.
    """
    law = environment.law
    for symbol, interval in zip(law.parameters(), environment.ranges, strict=True):
        yield Axis(symbol, interval, inverse=symbol in law.inverse)
    for other in memories:
        if other != environment and other.creep is not None:
            yield Axis(_rate(other), other.creep)


def _rate(environment: Environment) -> str:
    return f"r-{environment.name}"


def _rows_at(
    law: Admittance | ProportionalForce,
    environment: Environment,
    around: _Surroundings,
    values: Mapping[str, Fraction],
) -> list[Row]:
    """Return A at the given parameters of the contact and, in impedance control, gains."""
    motion = around.motion
    contact = environment.law(*(values[symbol] for symbol in environment.law.parameters()))
    if isinstance(law, ProportionalForce):
        return around.padded(force_mode(motion, law, contact, environment.name))
    gains = Admittance(values["Mt"], values["Bt"])
    if around.idle is not None:
        return impedance_rows(motion.A, list(motion.C), gains, contact)
    rows = impedance_mode(motion, gains, contact)
    if around.coordinates == "force":
        return to_force_coordinates(rows, motion, contact)
    memories = around.memories
    return _with_memories(rows, environment, memories, values) if memories else rows


def _with_memories(
    rows: list[Row],
    touched: Environment,
    memories: tuple[Environment, ...],
    values: Mapping[str, Fraction],
) -> list[Row]:
    """Put the memory of the touched environment, if any, in its place among all memories."""
    common = len(rows) - len(touched.law.states) + 1
    size = common + len(memories)
    places = [*range(common), *(common + i for i, e in enumerate(memories) if e == touched)]
    full = [[Fraction(0)] * size for _ in range(size)]
    for i, row in zip(places, rows, strict=True):
        for j, entry in zip(places, row, strict=True):
            full[i][j] = entry
    for i, environment in enumerate(memories, common):
        if environment != touched:
            full[i][i] = -values[_rate(environment)]
    return full


def impedance_mode(motion: Realization, law: Admittance, contact: AbstractLinearLaw) -> list[Row]:
    """Return A of an impedance mode in deflection coordinates (thesis 6.28).

    ``xp' = Ap xp + Bp (vc - vm)``, ``Mt vm' = -Bt vm + F``, and the law of the contact from
    ``v = Cp xp`` to F. With ``Mt = 0`` the velocity is ``vm = F / Bt``.

    Parameters
    ----------
    motion : Realization
        Of the motion loop.
    law : Admittance
        With its gains.
    contact : AbstractLinearLaw
        Of the environment, at fixed parameters.
    """
    reaction = contact.reaction
    n, m = motion.order, len(reaction.B)
    none = [Fraction(0)] * (law.Mt != 0)
    force = [*(reaction.D * c for c in motion.C), *none, *reaction.C]
    rows = [[*row, *none, *[Fraction(0)] * m] for row in motion.A]
    if law.Mt != 0:
        rows[-1][n] -= 1
        velocity = [f / law.Mt for f in force]
        velocity[n] -= law.Bt / law.Mt
        rows.append(velocity)
    else:
        rows[-1] = [entry - f / law.Bt for entry, f in zip(rows[-1], force, strict=True)]
    for gain, row in zip(reaction.B, reaction.A, strict=True):
        rows.append([*(gain * c for c in motion.C), *none, *row])
    return rows


def to_force_coordinates(
    rows: list[Row], motion: Realization, contact: AbstractLinearLaw
) -> list[Row]:
    """Replace the last state delta by the force ``F = k delta + b Cp xp`` (similarity T A T^-1).

    Parameters
    ----------
    rows : list of list of Fraction
        A in deflection coordinates.
    motion : Realization
        Of the motion loop.
    contact : AbstractLinearLaw
        Of the environment, at fixed parameters.
    """
    (stiffness,), damping = contact.reaction.C, contact.reaction.D
    size, n = len(rows), motion.order
    T = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
    inverse = [list(row) for row in T]
    T[-1][:n] = [damping * c for c in motion.C]
    T[-1][-1] = stiffness
    inverse[-1][:n] = [-damping * c / stiffness for c in motion.C]
    inverse[-1][-1] = 1 / stiffness
    return multiply(multiply(T, rows), inverse)


def force_mode(
    motion: Realization, law: ProportionalForce, contact: AbstractLinearLaw, environment: str
) -> list[Row]:
    """Return A of a force mode, ``Ap - Bp Kp k Cp`` (thesis 6.46).

    Parameters
    ----------
    motion : Realization
        Of the motion loop.
    law : ProportionalForce
        With its gain.
    contact : AbstractLinearLaw
        Of the environment, at fixed parameters.
    environment : str
        Its name, for errors.

    Raises
    ------
    AssemblyError
        If the environment of that name is no spring: with damping, its force depends on the input
        itself; with a memory, on more than the position.
    """
    reaction = contact.reaction
    if reaction.D != 0 or contact.remembers:
        raise AssemblyError(
            f"force control in contact with {environment}, which has damping, is not modelled",
            remedy="use an elastic environment for force controllers",
            at=("environments", environment, "damping"),
        )
    rows = [list(row) for row in motion.A]
    gain = law.Kp * reaction.C[0]
    rows[-1] = [entry - gain * c for entry, c in zip(rows[-1], motion.C, strict=True)]
    return rows


def _state_names(
    motion_order: int, size: int, coordinates: str, touched: tuple[Environment, ...]
) -> tuple[str, ...]:
    names = [f"xp{i + 1}" for i in range(motion_order)]
    if size == motion_order:
        return tuple(names)
    memories = [f"{e.name}: {state}" for e in touched for state in e.law.states[1:]]
    if size - motion_order - len(memories) == 2:
        names.append("vm [rad/s]")
    names.append("F [N*m]" if coordinates == "force" else touched[0].law.states[0])
    return (*names, *memories)


_INPUTS = (
    "All inputs are zero (velocity command, reference force, motion of the environment); all modes "
    "then rest at one point, the state zero.",
    "Under a constant command the modes may rest at different points. Where stability is proved, "
    "bounded inputs keep the state bounded; how far it goes, and that it settles, is not claimed.",
)
_KEPT_ALWAYS = "Contact is not lost: free motion is not one of the modes."
_KEPT_IN_IMPEDANCE = (
    "Contact is not lost while an impedance controller is active: free motion under one is not one "
    "of the modes."
)
_KEPT_IN_FORCE = (
    "Contact is not lost while force is controlled: the environment would pull as it pushes."
)


def _assumptions(
    design: ControllerDesign,
    coordinates: str,
    rules: SwitchingSpec,
    boxes: Mapping[str, GainBox],
    touched: tuple[Environment, ...],
    idle: IdleStatesSpec | None,
    *,
    given: bool,
) -> tuple[str, ...]:
    motion = (
        "The motion loop is the transfer function G(s) that the spec states, whatever the motion "
        "gains listed here."
        if given
        else "The motion loop is the linear actuator model of the spec, at its nominal values, "
        "under the motion gains listed here."
    )
    kept = tuple(
        text
        for law, text in (
            (Admittance, _KEPT_ALWAYS if idle is None else _KEPT_IN_IMPEDANCE),
            (ProportionalForce, _KEPT_IN_FORCE),
        )
        if any(isinstance(c.law, law) for c in design.controllers)
    )
    impedance = any(isinstance(c.law, Admittance) for c in design.controllers)
    contacts = [
        f"{c.name} is active only in contact with {' or '.join(c.contacts)}."
        for c in design.controllers
        if c.contacts
    ]
    ranged = {name: box for name, box in boxes.items() if not box.fixed}
    ranges = [text for name, box in ranged.items() for text in box.range_texts(name)]
    shipped = "The gains are the single-precision numbers listed here"
    last = {
        "deflection": "The deflection is continuous at a switch; the force may jump.",
        "force": "Wherever stiffness or damping changes, at a switch or within its range, the "
        "force stays and the deflection jumps (the thesis's coordinates; not physical in lasting "
        "contact).",
    }[coordinates]
    return (
        motion,
        *_INPUTS,
        "The axes of the robot do not act on each other.",
        *contacts,
        "In contact, the environment follows its linear model; its parameters stay in the "
        "declared ranges and may change arbitrarily fast.",
        *((last,) if impedance and all(e.law.has_rest for e in touched) else ()),
        *_memory_texts(touched),
        *(mixture_texts(idle, idle_size(design)) if idle is not None else ()),
        *kept,
        *_switch_texts(rules, reset=idle is not None and idle.reset),
        "Continuous time: sampling, delay, quantization, friction and saturation are not modelled.",
        f"{shipped}, or anywhere in their ranges." if ranged else f"{shipped}.",
        *ranges,
        *dict.fromkeys(box.memory_text for box in ranged.values()),
    )


def _memory_texts(touched: tuple[Environment, ...]) -> Iterator[str]:
    """Say what is taken for granted about environments that remember, or forget."""
    for environment in touched:
        if not environment.law.has_rest:
            yield (
                f"{environment.name} has no rest position: a lasting deflection leaves no force. "
                "Its state is the stretch of its spring, which stays at a switch and when the "
                "parameters change; "
                "that the deflection itself returns to zero is not claimed, nor that it stays "
                "bounded under a command or other input."
            )
        if environment.creep is None:
            continue
        yield (
            f"The damper of {environment.name} keeps its deflection at a switch and when the "
            "parameters change."
        )
        if len(touched) > 1:
            yield (
                f"While another environment is touched, {environment.name} is free of force and "
                "its damper creeps back to rest, b d' = -k1 d, with parameters in their ranges."
            )


def _switch_texts(rules: SwitchingSpec, *, reset: bool) -> tuple[str, ...]:
    states = "All other states are" if reset else "States are"
    if rules.is_arbitrary:
        return (f"{states} {CONTINUOUS}; any switching signal is possible.",)
    environment = (
        "While a controller is active, the environment that it touches may change among its "
        "contacts at any time."
    )
    contacts = () if rules.dwell_time is not None else (environment,)
    return (f"{states} {CONTINUOUS}.", *rule_texts(rules, "controller"), *contacts)
