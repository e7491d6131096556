"""Worst values of a controller, beside its goals.

The loop is that of the proved modes, cut where the law takes the force. Margins are taken in every
contact, nominal and at all corners of the ranges of contact and motor, sampled at every age of the
force sample; displayed impedance and force error in the contact of the design alone. The worst of a
goal is also looked for between the corners. All of it is floating point, and no proof: a goal is
met where it is proved over all ranges, where nothing has a range, or where a corner is surely the
worst.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import product
from math import isclose, pi, tan

import numpy as np

from nrs_design.controllers.laws import CompliantLaw
from nrs_design.design import measures
from nrs_design.design.force_loop import Approach, steady_force_error
from nrs_design.design.loop_family import LoopFamily
from nrs_design.design.loops import Loops, gain_extremes, hand_effort, transparency
from nrs_design.design.measures import GoalStanding, Measure
from nrs_design.design.transfer import (
    BoolArray,
    ComplexArray,
    FloatArray,
    TransferFunction,
    multiply,
)
from nrs_design.errors import DesignError
from nrs_design.loop.cut_loop import AbstractAxis, Place
from nrs_design.models.axis import unit
from nrs_design.models.contact import AbstractLinearLaw
from nrs_design.models.contact.environment import Environment

# Largest relative distance of a proved value from the worst found, to be shown instead.
_RELATIVE_GAP = 0.02
# In the place of a corner.
NOT_COMPUTED = "not computed: the force is sampled more often than the motion loop"


# Into how many parts a range is divided where the worst of a goal is looked for between corners: of
# one range, of each of two, of each of more.
_PARTS = (16, 4, 2)


@dataclass(frozen=True, slots=True)
class Achieved:
    """The worst value of one measure."""

    measure: Measure  # What is measured
    value: float  # The worst value, in SI units
    where: str  # The corner at which it is taken, such as ``soft, k = 44.2466 N*m/rad``
    goal: float | None = None  # Goal of the spec, in SI units
    # A proved bound for constant values in the ranges; None without a proof.
    proved: Fraction | None = None
    everywhere: bool = False  # True without ranges, and where the measure is worst at a corner

    @property
    def bound(self) -> Fraction | None:
        """The proved value, where it is close to the worst value found."""
        is_close = self.proved is not None and isclose(
            self.proved, self.value, rel_tol=_RELATIVE_GAP
        )
        return self.proved if is_close else None

    @property
    def text(self) -> str:
        """The shown value: a proved bound, else the worst value found."""
        return self.measure.text(self.value if self.bound is None else self.bound)

    @property
    def standing(self) -> GoalStanding:
        """How the goal stands; one that there is not is met."""
        if self.goal is None:
            return GoalStanding.MET
        if (missed := self.measure.violation(self.value, self.goal)) > 0:
            return GoalStanding.MISSED
        everywhere = self.everywhere and missed <= 0  # NaN is no success.
        return GoalStanding.MET if everywhere or self._is_proved else GoalStanding.NOT_JUDGED

    @property
    def basis(self) -> str:
        """What the standing of a goal rests on."""
        if self.standing is GoalStanding.NOT_JUDGED:
            return "not judged: floating point in some points, and no proof in between"
        if self.everywhere or not self._is_proved:
            return "floating point, not a proof"
        return "proved over all ranges"

    @property
    def _is_proved(self) -> bool:
        """Whether what is proved reaches the goal."""
        if self.proved is None or self.goal is None:
            return False
        limit = Fraction(self.goal)
        return self.proved <= limit if self.measure.upper else self.proved >= limit


@dataclass(frozen=True, slots=True)
class ContactCorner:
    """One contact that a controller is measured in, and where the motor is then."""

    label: str  # For people
    environment: str  # Its name
    contact: AbstractLinearLaw  # The environment there
    place: Place  # Motor and age of the force sample
    home: bool  # True for the environment of the design
    Kt: Fraction = Fraction(0)  # Spring of the admittance, N m/rad; zero is none


@dataclass(frozen=True)
class AbstractRequirement(ABC):
    """Goals of one controller, and all that is needed to measure it."""

    # From which the modes follow; None where no loop is cut at one place. What takes a loop is then
    # not computed: NaN.
    axis: AbstractAxis | None
    corners: tuple[ContactCorner, ...]  # From `corners_of`
    goals: tuple[tuple[Measure, float], ...]  # Goals in SI units

    def values(self, measure: Measure, *gains: FloatArray) -> tuple[FloatArray, list[str]]:
        """Return the worst value of a measure for every set of gains, and at which corner.

        Gains are those chosen by the goals, in SI: Mt and Bt of an admittance, each of shape (m,).
        """
        count = len(gains[0]) if gains else 1
        if self.axis is None and measure not in measures.CREEP_MEASURES:
            return np.full(count, np.nan), [NOT_COMPUTED] * count
        corners = [*self._iterate_corners(measure)]
        if measure in _MARGINS:
            table = np.array([_MARGINS[measure](loops) for loops in self._loops(*gains)])
        else:
            table = np.array([self._at(corner, measure, *gains) for corner in corners])
        worst = table.argmax(axis=0) if measure.upper else table.argmin(axis=0)
        values = np.take_along_axis(table, worst[None, :], axis=0)[0]
        is_free = measure in measures.CREEP_MEASURES
        return values, ["free motion" if is_free else corners[i].label for i in worst]

    def achieved(self, measures_asked: tuple[Measure, ...], *gains: float) -> tuple[Achieved, ...]:
        """Return the worst value of every measure, beside its goal.

        Where corners meet the goal, it is also looked for between them.
        """
        return tuple(self._achieved(measure, *gains) for measure in measures_asked)

    def _achieved(self, measure: Measure, *gains: float) -> Achieved:
        arrays = tuple(np.array([gain]) for gain in gains)
        (value,), (place,) = self.values(measure, *arrays)
        found = Achieved(
            measure,
            float(value),
            place,
            dict(self.goals).get(measure),
            everywhere=measure in measures.MONOTONE or self._is_one_point(measure),
        )
        if found.goal is None or found.standing is not GoalStanding.NOT_JUDGED or np.isnan(value):
            return found
        (value,), (place,) = replace(self, corners=self._inner_corners).values(measure, *arrays)
        worst = replace(found, value=float(value), where=place)
        return worst if worst.standing is GoalStanding.MISSED else found

    def _loops(self, *gains: FloatArray) -> list[Loops]:
        """Return the open loops at all corners, made once for all measures of the same gains."""
        key = tuple(each.tobytes() for each in gains)
        if key not in self._cache:
            self._cache.clear()
            self._cache[key] = [self.loops(corner, *gains) for corner in self.corners]
        return self._cache[key]

    @cached_property
    def _cache(self) -> dict[tuple[bytes, ...], list[Loops]]:
        return {}

    def _iterate_corners(self, measure: Measure) -> Iterator[ContactCorner]:
        return (
            corner
            for corner in self.corners
            if corner.home or measure not in measures.CONTACT_MEASURES
        )

    def _is_one_point(self, measure: Measure) -> bool:
        """Tell whether nothing has a range; each age of the force counts alone."""
        found: dict[tuple[str, int], set[object]] = {}
        for corner in self._iterate_corners(measure):
            place = replace(corner.place, age=0, texts=())
            point = corner.contact, place, corner.Kt
            found.setdefault((corner.environment, corner.place.age), set()).add(point)
        return all(len(points) == 1 for points in found.values())

    @cached_property
    def _inner_corners(self) -> tuple[ContactCorner, ...]:
        """Points of the contacts between their corners."""
        groups: dict[tuple[str, Place], list[ContactCorner]] = {}
        for corner in self.corners:
            groups.setdefault((corner.environment, corner.place), []).append(corner)
        return tuple(inner for group in groups.values() for inner in _inner_points(group))

    @abstractmethod
    def loops(self, corner: ContactCorner, *gains: FloatArray) -> Loops:
        """Return the open loops at a corner."""

    @abstractmethod
    def _at(self, corner: ContactCorner, measure: Measure, *gains: FloatArray) -> FloatArray:
        """Return a measure that is no margin of the loops."""


@dataclass(frozen=True)
class Requirement(AbstractRequirement):
    """Goals of one impedance controller."""

    goals: tuple[tuple[Measure, float], ...] = ()  # Goals in SI units
    desired: float = 0.0  # Desired impedance, N m s/rad
    bandwidth: float = 0.0  # Highest frequency of the command, rad/s
    force_error: float = 0.0  # Bound on the lasting error of the force signal, N m

    @cached_property
    def nominal(self) -> tuple[ContactCorner, ...]:
        """Nominal contact and motor, at every age of the force sample."""
        first = next(corner for corner in self.corners if corner.home)
        return tuple(
            corner
            for corner in self.corners
            if corner.home
            and corner.contact == first.contact
            and corner.place.motor == first.place.motor
        )

    def stable(self, Mt: FloatArray, Bt: FloatArray) -> BoolArray:
        """Tell for which admittances nominal contact is stable, at every age of the force."""
        loops = [self.loops(corner, Mt, Bt) for corner in self.nominal]
        return np.asarray(np.all([each.stable for each in loops], axis=0))

    def corner(self, label: str) -> ContactCorner:
        """Return the corner, or point between corners, of a label."""
        points = (*self.corners, *self._inner_corners)
        return next(corner for corner in points if corner.label == label)

    def violation(self, Mt: FloatArray, Bt: FloatArray) -> FloatArray:
        """Return by which part the worst goal is missed; not positive where all are met."""
        worst = np.full(len(Mt), -np.inf)
        for measure, goal in self.goals:
            values = self.values(measure, Mt, Bt)[0]
            missed = [measure.violation(float(value), goal) for value in values]
            worst = np.maximum(worst, missed)
        return worst

    def loops(self, corner: ContactCorner, *gains: FloatArray) -> Loops:
        """Return the open loops at a corner, for Mt and Bt."""
        Mt, Bt = gains
        return self.family(corner).loops(Mt, Bt, corner.contact.stiffness)

    def displayed(
        self, corner: ContactCorner, Mt: float, Bt: float, omega: FloatArray
    ) -> ComplexArray | None:
        """Return the displayed impedance in N m s/rad at frequencies in rad/s.

        Sampled, but for its phase. None where it is not computed: for a sampled law with a spring.
        """
        if self.axis is None or (corner.Kt and self.axis.period is not None):
            return None
        (found,) = self._displayed_loops(corner, np.array([Mt]), np.array([Bt])).response(omega)
        return np.asarray(found)

    def _displayed_loops(self, corner: ContactCorner, Mt: FloatArray, Bt: FloatArray) -> Loops:
        """Return the displayed impedances at a corner, as what is open."""
        loops = self.loops(corner, Mt, Bt)
        numerator, denominator = self.family(corner).over_admittance(Mt, Bt)
        return Loops(
            multiply(loops.numerator, numerator), multiply(loops.closed, denominator), loops.period
        )

    def stiffness_limits(self, Mt: float, Bt: float) -> dict[str, tuple[float, str]]:
        """Return the smallest stiffness limit in N m/rad in every environment, and where it is."""
        if self.axis is None:
            return {c.environment: (np.nan, NOT_COMPUTED) for c in self.corners}
        found: dict[str, tuple[float, str]] = {}
        for corner in self.corners:
            limit = self.family(corner).stiffness_limit(Mt, Bt)
            if corner.environment not in found or limit < found[corner.environment][0]:
                found[corner.environment] = limit, corner.label
        return found

    def family(self, corner: ContactCorner) -> LoopFamily:
        """Return the loops of all admittances in a contact, made once."""
        key = corner.contact.replace_stiffness(Fraction(1)), corner.Kt, corner.place
        assert self.axis is not None, "without an axis there are no loops"
        if key not in self._families:
            self._families[key] = LoopFamily(self.axis, *key)
        return self._families[key]

    @cached_property
    def _families(self) -> dict[tuple[AbstractLinearLaw, Fraction, Place], LoopFamily]:
        return {}

    def _at(self, corner: ContactCorner, measure: Measure, *gains: FloatArray) -> FloatArray:
        Mt, Bt = gains
        if measure is measures.CREEP:
            return np.zeros_like(Bt) if corner.Kt else self.force_error / Bt
        if measure is measures.CREEP_ANGLE:
            angle = self.force_error / float(corner.Kt) if corner.Kt else np.inf
            return np.full_like(Bt, angle)
        if measure in (measures.TRANSPARENCY, measures.HAND_EFFORT):
            return self._measure_hand(corner, measure, Mt, Bt)
        if corner.Kt:  # Towards rest the robot displays the spring, and no damping.
            return np.full(len(Mt), np.inf)
        loops = self._displayed_loops(corner, Mt, Bt)
        low, high = gain_extremes(loops.numerator, loops.denominator, self._seen_bandwidth)
        error = np.maximum(high / self.desired, self.desired / low)
        return np.where(self.loops(corner, Mt, Bt).stable, error, np.inf)

    def _measure_hand(
        self, corner: ContactCorner, measure: Measure, Mt: FloatArray, Bt: FloatArray
    ) -> FloatArray:
        """Return a measure of the hand that holds the robot."""
        if self.axis is not None and self.axis.period is not None:
            raise DesignError(
                f"the {measure.title} is not computed for a sampled loop",
                remedy=f"leave {measure.goal} out, or sampling",
                at=("goals", measure.goal),
            )
        loops = self.family(corner).felt(Mt, Bt, corner.contact.stiffness)
        if measure is measures.TRANSPARENCY:
            return transparency(loops, self.bandwidth)
        return hand_effort(loops, corner.contact, self.bandwidth)

    @property
    def _seen_bandwidth(self) -> float:
        """The bandwidth on the axis of the loops, at most half the sampling rate."""
        if self.axis is None or self.axis.period is None:
            return self.bandwidth
        half = float(self.axis.period) / 2
        return tan(min(self.bandwidth * half, pi / 2 * _NEARLY)) / half


_NEARLY = 1 - 1e-9  # Half the sampling rate is at infinity


@dataclass(frozen=True)
class ForceRequirement(AbstractRequirement):
    """Goals of one force controller."""

    law: CompliantLaw  # With the gains that ship
    # Closed motion loop G, from commanded to actual position, for the steady error.
    motion: TransferFunction
    approach: Approach  # Approach to the force limit, for the steady error

    def _at(self, corner: ContactCorner, measure: Measure, *gains: FloatArray) -> FloatArray:
        error = self.steady_error(corner.contact, corner.place)
        return np.where(self.loops(corner).stable, error, np.inf)

    def steady_error(self, contact: AbstractLinearLaw, place: Place) -> float:
        """Return the force error that is left in the end, over Fd.

        Without offset it is what the loop as it is proved makes of a lasting force: ``D/(D + N)``
        at rest, with the relaxation of the contact and what it pushes a motor with a load back.
        """
        if self.approach.offset != "none" or self.axis is None:
            gain = float(self.law.gains["Kp"])
            return steady_force_error(self.motion, contact.stiffness, gain, self.approach)
        cut = self.axis.find_loop(self.law, contact, place)
        return abs(float(cut.opened[-1] / cut.closed[-1])) if cut.closed[-1] else math.inf

    def loops(self, corner: ContactCorner, *gains: FloatArray) -> Loops:
        """Return the open loop at a corner."""
        assert self.axis is not None, "without an axis there are no loops"
        cut = self.axis.find_loop(self.law, corner.contact, corner.place)
        return Loops.from_cut(cut, self.axis.period)


def corners_of(
    environments: tuple[Environment, ...],
    home: str,
    places: tuple[Place, ...],
    spring: Fraction = Fraction(0),
) -> tuple[ContactCorner, ...]:
    """List where a controller is measured: contacts, and places of the motor.

    `home` is the contact designed for; the spring is in N m/rad.
    """
    found = []
    for environment in environments:
        points = list(environment.corners)
        if environment.nominal not in points:
            points.insert(0, environment.nominal)
        for contact, place in product(points, places):
            label = f"{environment.name}, {', '.join((*contact.texts(unit), *place.texts))}"
            is_home = environment.name == home
            found.append(ContactCorner(label, environment.name, contact, place, is_home, spring))
    return tuple(found)


def _inner_points(group: Sequence[ContactCorner]) -> Iterator[ContactCorner]:
    """Yield points of the box whose corners are a group, and those corners."""
    yield from group
    first = group[0]
    sides = [(min(ends), max(ends)) for ends in zip(*(c.contact.exact for c in group), strict=True)]
    count = sum(low < high for low, high in sides)
    parts = _PARTS[min(count, len(_PARTS)) - 1]
    grids = [
        [low + (high - low) * i / parts for i in range(parts + 1)] if low < high else [low]
        for low, high in sides
    ]
    known = {corner.contact.exact for corner in group}
    for values in product(*grids):
        if values not in known:
            contact = type(first.contact)(*values)
            texts = (*contact.texts(unit), *first.place.texts)
            yield replace(first, contact=contact, label=f"{first.environment}, {', '.join(texts)}")


_MARGINS = {
    measures.SENSITIVITY_PEAK: Loops.sensitivity_peak,
    measures.GAIN_MARGIN: Loops.gain_margin,
    measures.PHASE_MARGIN: Loops.phase_margin,
    measures.DELAY_MARGIN: Loops.delay_margin,
    measures.DISK_MARGIN: Loops.disk_margin,
}
