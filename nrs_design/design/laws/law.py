"""Choice and analysis of gains, for any law."""

from __future__ import annotations

from abc import ABC
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from nrs_design.controllers.controller_design import Controller, ImpedanceOptimum
from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws import LAWS, CompliantLaw, ProportionalDerivative
from nrs_design.controllers.sensor import Sensor, build_sensor
from nrs_design.design.doubts import doubt_values, is_unusual
from nrs_design.design.goals import Achieved, ContactCorner, corners_of
from nrs_design.design.measures import Measure
from nrs_design.design.proved_margins import RangedLoop, add_proofs
from nrs_design.design.transfer import TransferFunction
from nrs_design.errors import DesignError
from nrs_design.loop.cut_loop import AbstractAxis, Place, axis_of
from nrs_design.models.contact.environment import Environment
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.models.plant import Plant
from nrs_design.spec import ControllerSpec, Doubt, GainSpec, InteractionDesignSpec, Quantity
from nrs_design.spec.controllers import contact_names
from nrs_design.spec.quantity import exact_number


@dataclass(frozen=True)
class Task:
    """Spec, plant and motion controller of a design."""

    spec: InteractionDesignSpec  # Requirements and bounds
    plant: Plant  # Plant of the spec
    pd: ProportionalDerivative  # The motion controller

    @property
    def loop(self) -> MotionLoop:
        """The motion loop in use."""
        return self.plant.motion_loop(self.pd.Kp, self.pd.Kd)

    @property
    def motion(self) -> TransferFunction:
        """The motion loop in floating point."""
        numerator, denominator = self.loop.numerator, self.loop.denominator
        return TransferFunction(tuple(map(float, numerator)), tuple(map(float, denominator)))

    @cached_property
    def axis(self) -> AbstractAxis | None:
        """From which the modes of a proof follow; None where no loop is cut at one place."""
        return axis_of(self.spec, self.plant, self.pd, self.sensor)

    def corners(
        self, spec: ControllerSpec, spring: Fraction = Fraction(0)
    ) -> tuple[ContactCorner, ...]:
        """Return where a controller is measured."""
        assert spec.environment is not None  # A controller with contact has one.
        places = (Place(self.plant.actuator),) if self.axis is None else self.axis.places
        return corners_of(self.contacts(spec), spec.environment, places, spring)

    @property
    def sensor(self) -> Sensor:
        """The sensor of the force that the controllers act on."""
        return build_sensor(self.spec.sensor)

    def contacts(self, given: ControllerSpec) -> tuple[Environment, ...]:
        """Return the contacts of a controller, with the environment of its design."""
        assert given.environment is not None  # A controller with contact has one.
        names = dict.fromkeys((*contact_names(given.contacts), given.environment))
        return tuple(map(self.plant.environment, names))

    def stiffness(self, given: ControllerSpec) -> float:
        """Return the stiffness of nominal contact in the environment of the design, in N m/rad."""
        assert given.environment is not None  # A controller with contact has one.
        return self.plant.environment(given.environment).nominal.stiffness

    def followed(self, given: ControllerSpec) -> TransferFunction:
        """Return G, and how a filter and the relaxation of nominal contact let the force follow."""
        assert given.environment is not None  # A controller with contact has one.
        numerator, denominator = self.motion.numerator, self.motion.denominator
        rates = self.plant.environment(given.environment).nominal.memory_rates
        if rates is not None:
            decays, follows = map(float, rates)
            numerator = tuple(np.polymul(numerator, (1.0, decays)))
            denominator = tuple(np.polymul(denominator, (1.0, decays + follows)))
        if (low_pass := self.sensor.filter) is not None:
            for _ in range(low_pass.order):
                denominator = tuple(np.polymul(denominator, (1 / float(low_pass.pole), 1.0)))
        return TransferFunction(numerator, denominator)

    @property
    def digits(self) -> int:
        """How many digits a designed gain has."""
        return self.spec.design.significant_digits


@dataclass(frozen=True)
class AbstractControllerAnalysis(ABC):
    """Worst values of one controller."""

    name: str  # Name of the controller
    achieved: tuple[Achieved, ...]  # The worst values over the contacts, beside the goals
    # Over whose ranges margins can be proved; empty where they cannot.
    loops: tuple[RangedLoop, ...] = field(default=(), kw_only=True)

    @property
    def unusual(self) -> tuple[Measure, ...]:
        """Measures beyond their usual limit that no goal limits."""
        return tuple(
            item.measure for item in self.achieved if is_unusual(item.measure, self.achieved)
        )

    @cached_property
    def judged(self) -> tuple[Achieved, ...]:
        """Worst values with their proofs over the ranges."""
        goals = {found.measure: found for found in self.judged_goals}
        others = iter(self.prove([found for found in self.achieved if found.goal is None]))
        return tuple(goals.get(found.measure) or next(others) for found in self.achieved)

    @cached_property
    def judged_goals(self) -> tuple[Achieved, ...]:
        """Worst values with a goal, and their proofs; a gate needs no others."""
        return self.prove([found for found in self.achieved if found.goal is not None])

    def prove(self, achieved: Sequence[Achieved]) -> tuple[Achieved, ...]:
        """Return worst values with their proofs over the ranges."""
        return add_proofs(achieved, self.loops)

    @property
    def proved_titles(self) -> tuple[str, ...]:
        """What is proved over all values of the ranges."""
        return tuple(found.measure.title for found in self.judged if found.bound is not None)

    def doubts(self) -> Iterator[Doubt]:
        """Yield doubts about the gains that no goal settles."""
        yield from doubt_values(self.name, self.achieved, provable=bool(self.loops))


# A law with its gains, and the optimum before rounding, if there was a search.
Choice = tuple[CompliantLaw, ImpedanceOptimum | None]


@dataclass(frozen=True)
class LawDesign:
    """Functions that choose and analyze the gains of one law."""

    choose: Callable[[Task, Any], Choice]  # Gives the law for a task and the spec of a controller
    # Takes task, spec of the controller and controller with its gains; None without measures.
    analyze: Callable[[Task, Any, Controller], AbstractControllerAnalysis] | None = None
    # Takes the same, and yields too stiff contacts with advice; None where that is not known.
    too_stiff: Callable[[Task, Any, Controller], Iterator[Doubt]] | None = None


def choose_given(task: Task, given: ControllerSpec) -> Choice:
    """Return the law with the gains that the spec fixes; one left open is a `DesignError`."""
    law, gains = LAWS[given.type], dict[str, Fraction]()
    for name in law.gain_names(given):
        value = getattr(given, law.fixed.get(name, name))
        if isinstance(value, GainSpec):
            value = value.min if value.fixed else None
        if value is None:
            raise DesignError(
                f"nothing chooses {name} of a {law.name} controller",
                remedy="give its value",
                at=(law.fixed.get(name, name),),
            )
        gains[name] = round_float32(exact_number(value))
    return law.create(gains), None


GIVEN = LawDesign(choose_given)  # For laws with given gains and without measures


@contextmanager
def naming(controller: str) -> Iterator[None]:
    """Say in an error which controller it is about."""
    try:
        yield
    except DesignError as error:
        message = f"controller {controller}: {error.message}"
        place = ("controllers", controller, *error.at)
        raise DesignError(message, remedy=error.remedy, at=place) from error


def goals_of(
    spec: InteractionDesignSpec, controller: ControllerSpec, measures: tuple[Measure, ...]
) -> tuple[tuple[Measure, float], ...]:
    """Return the goals of one controller: the spec's own, replaced by those of the controller."""
    given: dict[str, Quantity | Fraction] = {}
    for goals in (spec.goals, controller.goals):
        found = goals.given() if goals is not None else ()
        given |= {key: value for key, value in found if isinstance(value, Quantity | Fraction)}
    return tuple(
        (measure, _number(given[measure.goal])) for measure in measures if measure.goal in given
    )


def _number(value: Quantity | Fraction) -> float:
    return value.si if isinstance(value, Quantity) else float(value)
