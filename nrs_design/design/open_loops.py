"""The open loops whose margins a design has, as A, B and C: what other programs take margins of.

`nrs_design.loop.cut_loop` cuts the modes of a proof where the law takes the force. Two such
modes, with the force and without it, differ by a column times a row, exactly: ``-B C``. With A of
the mode without it, ``L = C (s I - A)^-1 B``, and ``A - B C`` is the mode that is proved.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.design.goals import ContactCorner
from nrs_design.design.laws.law import Task
from nrs_design.design.loops import Loops
from nrs_design.loop.cut_loop import AbstractAxis
from nrs_design.models.plant import Plant
from nrs_design.spec import InteractionDesignSpec

Matrix = NDArray[np.float64]
Rows = Sequence[Sequence[Fraction]]


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
    task = Task(spec, plant, design.motion)
    if task.axis is None:
        return ()
    return tuple(loop for item in design.controllers for loop in _of(task, task.axis, item))


def _of(task: Task, axis: AbstractAxis, controller: Controller) -> Iterator[OpenLoop]:
    """Yield the loops of a controller; one that takes no force has none."""
    given = task.spec.controllers[controller.name]
    for corner in () if given.environment is None else task.corners(given):
        yield _at(axis, controller, corner)


def _at(axis: AbstractAxis, controller: Controller, corner: ContactCorner) -> OpenLoop:
    opened, closed = axis.modes(controller.law, corner.contact, corner.place)
    column, row = _factors(opened, closed)
    cut = axis.cut(controller.law, corner.contact, corner.place)
    return OpenLoop(
        controller.name,
        corner.label,
        np.array([[float(entry) for entry in line] for line in opened]),
        np.array([[float(entry)] for entry in column]),
        np.array([[-float(entry) for entry in row]]),
        Loops.of_cut(cut, axis.period),
    )


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
