"""Boxes of physical parameters: one matrix for each corner, and the check that corners suffice.

A matrix that is affine in each parameter alone (all others held) is, anywhere in the box, a
convex combination of its corners, with weights that are products of the shares along the axes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.errors import InternalError
from nrs_design.loop.located import labelled_ends
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import JointMotionLoop
from nrs_design.models.plant import Plant

Rows = Sequence[Sequence[Fraction]]
RowsFunction = Callable[[Mapping[str, Fraction]], Rows]

# Between the ends of a range, which are labelled as `Interval.ends` does.
MIDDLE = "middle"


@dataclass(frozen=True, slots=True)
class Box:
    """Where the parameters of a matrix lie."""

    ranges: Mapping[str, Interval]  # By symbols such as ``k`` or ``Mt``; a point adds no corners
    # Positive parameters p such that matrices are affine in 1/p. The corners are the same: the ends
    # of 1/p are the inverse ends of p.
    inverse: frozenset[str] = frozenset()

    def join(self, box: Box) -> Box:
        """Return the box of the parameters of both, which have no symbol in common."""
        if common := self.ranges.keys() & box.ranges.keys():
            raise InternalError(f"the symbol {min(common)} stands for two parameters")
        return Box({**self.ranges, **box.ranges}, self.inverse | box.inverse)

    def corners(self, evaluate: RowsFunction, name: str) -> Iterator[tuple[tuple[str, ...], Rows]]:
        """Yield the labels and matrices of the corners, the last parameter turning fastest.

        An `InternalError` if the matrix of that mode is not affine along each axis. That follows
        from the formulas of the loop, and is computed again because a proof for the whole box rests
        on it: on the grid of low end, middle and high end of every axis, the matrix must be the
        mean of its two neighbors along one axis on which it is in the middle. For entries of a
        degree of at most two in each coordinate this decides it, and the matrix at any place is a
        mean of those at the corners around it.
        """
        known: dict[tuple[str, ...], Rows] = {}
        # Neighbors have fewer middles, so the order of middles computes neighbors first.
        for place, values in sorted(self._grid(), key=lambda item: item[0].count(MIDDLE)):
            known[place] = evaluate(values)
            if MIDDLE not in place:
                continue
            i = place.index(MIDDLE)
            low, high = (known[*place[:i], end, *place[i + 1 :]] for end in ("min", "max"))
            for rows in zip(known[place], low, high, strict=True):
                # Most rows do not change at all along an axis.
                row, x, y = map(tuple, rows)
                if not row == x == y and any(2 * c != p + q for c, p, q in zip(*rows, strict=True)):
                    message = f"the matrix of mode {name} is not affine in each parameter"
                    raise InternalError(message)
        corners = (corner for place, corner in known.items() if MIDDLE not in place)
        for (labels, _), corner in zip(labelled_ends(self.ranges), corners, strict=True):
            yield labels, corner

    def _grid(self) -> Iterator[tuple[tuple[str, ...], dict[str, Fraction]]]:
        """Yield labels and values at the ends of all ranges, and halfway where they are affine."""
        axes = []
        for symbol, interval in self.ranges.items():
            middle = interval.middle
            if symbol in self.inverse:
                middle = 2 / (1 / interval.low + 1 / interval.high)
            axes.append([*interval.ends, *[(MIDDLE, middle)] * len(interval.ends[1:])])
        for place in product(*axes):
            values = zip(self.ranges, (value for _, value in place), strict=True)
            yield tuple(label for label, _ in place), dict(values)


@dataclass(frozen=True, slots=True)
class Joint:
    """The motion loop in its physical state, wherever gain and time constant of the motor are."""

    motion: ProportionalDerivative  # The PD gains that ship
    ranges: ActuatorRanges  # Where the motor may be
    load_inertia: Fraction | None  # The J of `nrs_design.models.motion_loop.JointMotionLoop`

    @classmethod
    def from_plant(cls, plant: Plant, motion: ProportionalDerivative) -> Joint | None:
        """Return the joint of a plant, or None where its motor is a point and carries no load."""
        ranges = plant.actuator_ranges
        if ranges.fixed and plant.load_inertia is None:
            return None
        return cls(motion, ranges, plant.load_inertia)

    @property
    def box(self) -> Box:
        """The box in which the loop is affine in the gain, and in one over the time constant."""
        return Box({"Km": self.ranges.gain, "tau": self.ranges.time_constant}, frozenset({"tau"}))

    @property
    def nominal(self) -> JointMotionLoop:
        """The loop that the design uses."""
        motor = self.ranges.nominal
        return self.evaluate({"Km": motor.gain, "tau": motor.time_constant})

    def evaluate(self, values: Mapping[str, Fraction]) -> JointMotionLoop:
        """Return the loop at the values of ``Km`` and ``tau``."""
        gains = self.motion.Kp, self.motion.Kd
        return JointMotionLoop(*gains, values["Km"], values["tau"], self.load_inertia)
