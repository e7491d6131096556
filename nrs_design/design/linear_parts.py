"""Plant, controllers and contacts of one axis, and its open loops, as A, B, C and D, with units.

Parts are in continuous time and at nominal values. A closed loop is the feedback of these parts and
of nothing else, but where what is touched acts on the motor (`load_inertia`).

Open loops are cut where the law takes the force (`nrs_design.loop.cut_loop`). Two modes, with the
force and without it, differ by a column times a row, exactly: ``-B C``. With A of the mode without
it, ``L = C (s I - A)^-1 B``, and ``A - B C`` is the mode that is proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.sensor import LowPass
from nrs_design.design.laws.law import Task
from nrs_design.design.loops import Loops
from nrs_design.design.transfer import controllable_form
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.models.drive import CommandInterface
from nrs_design.models.linear_form import coordinates, zero
from nrs_design.models.plant import Plant
from nrs_design.spec import InteractionDesignSpec

Matrix = NDArray[np.float64]
Rows = Sequence[Sequence[Fraction]]
UNITS = {"velocity": "rad/s", "position": "rad"}
FORCE = "N*m"


@dataclass(frozen=True, slots=True)
class LinearPart:
    """A linear system with one input."""

    name: str  # Name of the part
    # ``x' = A x + B u``, ``y = C x + D u``; shapes (n, n), (n, 1), (m, n), (m, 1).
    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix
    input: tuple[str, str]  # Name and unit of u
    outputs: tuple[tuple[str, str], ...]  # Name and unit of each y


@dataclass(frozen=True, slots=True)
class LinearParts:
    """All of one axis."""

    # actuator, motion_loop: from the command of the motor to the position, and from commanded to
    # measured motion.
    actuator: LinearPart
    motion_loop: LinearPart
    controllers: tuple[LinearPart, ...]  # Laws, from measured force to added command
    force_filter: LinearPart | None  # Through which the laws get the force
    contacts: tuple[LinearPart, ...]  # Contacts, from motion to force


def linear_parts(plant: Plant, design: ControllerDesign) -> LinearParts:
    """Return plant, controllers and contacts at nominal values."""
    loop, low_pass = plant.motion_loop(design.motion.Kp, design.motion.Kd), design.sensor.filter
    lag = plant.actuator.time_constant, Fraction(1), Fraction(0)
    # From velocities to velocities, or from positions to positions.
    command, motion = ("command", "rad/s or rad"), ("motion", "rad/s or rad")
    return LinearParts(
        _part_of_transfer(
            "actuator",
            (plant.actuator.gain,),
            lag,
            ("command", design.command),
            ("position", "rad"),
        ),
        _part_of_transfer("motion_loop", loop.numerator, loop.denominator, command, motion),
        tuple(
            _controller_part(item, measured=design.takes is CommandInterface.VELOCITY)
            for item in design.controllers
        ),
        None if low_pass is None else _filter_part(low_pass),
        tuple(_contacts(plant, design)),
    )


def _controller_part(controller: Controller, *, measured: bool) -> LinearPart:
    """Return a law, from measured force to added command.

    Where it has a spring, the offset q that the spring acts on is a state; where that is the
    `measured` position, the force of the spring is a part of its input.
    """
    law = controller.law
    count, spring = len(law.states), 0 if measured else law.spring
    size = count + (spring != 0) + 1
    forms = coordinates(size)
    force = list(forms[-1])
    if spring:
        force[count] -= spring
    command, rates = law.respond(force, forms[:count])
    if spring:
        rates = [*rates, [-entry for entry in command]]
    name = "force_and_spring" if law.spring and measured else "force"
    return _part_of_rows(
        controller.name, rates, command, (name, FORCE), (law.commands, UNITS[law.commands])
    )


def _filter_part(low_pass: LowPass) -> LinearPart:
    """Return the filter of the force, from the force to what the laws get."""
    forms = coordinates(low_pass.order + 1)
    filtered, rates = low_pass.respond(forms[-1], forms[:-1])
    return _part_of_rows(
        "force_filter", rates, filtered, ("force", FORCE), ("filtered_force", FORCE)
    )


def _contact_part(name: str, contact: AbstractLinearLaw, motion: str) -> LinearPart | None:
    """Return a contact, from velocity or position to force; None if it is not proper."""
    if contact.has_mass:
        return None
    own, output = len(contact.states), ("contact_force", FORCE)
    if motion == "velocity":
        forms = coordinates(own + 1)
        force, rates = contact.react(forms[-1], forms[:-1])
        return _part_of_rows(name, rates, force, ("velocity", "rad/s"), output)
    # From a position: only a spring, whose force does not depend on velocity.
    damped, _ = contact.react(coordinates(1)[0], [zero(1)] * own)
    if own > 1 or any(damped):
        return None
    force, _ = contact.react(zero(1), coordinates(1))
    return _part_of_rows(name, [], force, ("position", "rad"), output)


def _contacts(plant: Plant, design: ControllerDesign) -> Iterator[LinearPart]:
    """Yield each contact, for velocity or position commands as its controllers give."""
    for environment in plant.environments:
        kinds = {c.law.commands: None for c in design.controllers if environment.name in c.contacts}
        parts = (_contact_part(environment.name, environment.nominal, kind) for kind in kinds)
        yield from (part for part in parts if part is not None)


def _part_of_rows(
    name: str,
    rates: Rows,
    output: Sequence[Fraction],
    inputs: tuple[str, str],
    out: tuple[str, str],
) -> LinearPart:
    """Return the system of rates and an output, each of all states and of the input at the end."""
    size = len(output)
    rows = np.zeros((size, size))
    for index, row in enumerate([*rates, output]):
        rows[index] = [float(entry) for entry in row]
    A, B, C, D = rows[:-1, :-1], rows[:-1, -1:], rows[-1:, :-1], rows[-1:, -1:]
    return LinearPart(name, A, B, C, D, inputs, (out,))


def _part_of_transfer(
    name: str,
    numerator: Sequence[Fraction],
    denominator: Sequence[Fraction],
    given: tuple[str, str],
    out: tuple[str, str],
) -> LinearPart:
    """Return the controllable canonical form of a strictly proper transfer function."""
    A, C = controllable_form(numerator, denominator)
    return LinearPart(name, A, np.eye(len(A))[:, -1:], C[None], np.zeros((1, 1)), given, (out,))


@dataclass(frozen=True, slots=True)
class OpenLoop:
    """The loop of one controller at one corner."""

    controller: str  # Its name
    at: str  # The corner, in words
    # ``x' = A x + B u``, or a step of it; ``y = C x``, where u is the force that the law takes and
    # y what comes back of it, with its sign turned. Shapes (n, n), (n, 1), (1, n).
    A: Matrix
    B: Matrix
    C: Matrix
    loops: Loops  # The same by its polynomials, which margins are taken of


def open_loops(
    spec: InteractionDesignSpec, plant: Plant, design: ControllerDesign
) -> tuple[OpenLoop, ...]:
    """Return the open loops of the designed gains, at every corner of contacts and motor.

    None where no loop is cut at one place: the force is sampled more often than the motion.
    """
    task, found = Task(spec, plant, design.motion), []
    if (axis := task.axis) is None:
        return ()
    for controller in design.controllers:
        given, law = spec.controllers[controller.name], controller.law
        # One that takes no force has no loop.
        for corner in () if given.environment is None else task.corners(given):
            opened, closed = axis.modes(law, corner.contact, corner.place)
            column, row = _factors(opened, closed)
            loops = Loops.from_cut(axis.find_loop(law, corner.contact, corner.place), axis.period)
            A, B, C = (np.array(M, dtype=np.float64) for M in (opened, [column], [row]))
            found.append(OpenLoop(controller.name, corner.label, A, B.T, -C, loops))
    return tuple(found)


def _factors(opened: Rows, closed: Rows) -> tuple[list[Fraction], list[Fraction]]:
    """Return the column and the row whose product is what the force adds to a mode."""
    added = [
        [Fraction(c) - Fraction(o) for c, o in zip(*lines, strict=True)]
        for lines in zip(closed, opened, strict=True)
    ]
    row = next((line for line in added if any(line)), None)
    if row is None:  # A contact without a force.
        return [Fraction(0)] * len(added), [Fraction(0)] * len(added)
    pivot = next(j for j, entry in enumerate(row) if entry)
    column = [line[pivot] / row[pivot] for line in added]
    assert added == [[x * y for y in row] for x in column], "the force enters at one place"
    return column, row
