"""The free gains of all controllers as one point of logarithms.

They are Mt and Bt of the impedance controllers, and the gains in ``design.free``. All virtual
masses are zero, or none is: these are different laws.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from nrs_design.controllers.float32 import round_float32
from nrs_design.errors import DesignError
from nrs_design.models.axis import unit
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.pipeline.design import Designed
from nrs_design.pipeline.gain_coordinate import (
    BOUNDED,
    GainCoordinate,
    Written,
    bounded_gain,
    freed_gains,
)
from nrs_design.proof.text import exact_text
from nrs_design.spec.interaction_parts import MOTION

if TYPE_CHECKING:
    from nrs_design.controllers.controller_design import ControllerDesign
    from nrs_design.design.analysis import DesignAnalysis, ImpedanceAnalysis
    from nrs_design.design.goals import Requirement
    from nrs_design.design.impedance_optimum import ImpedanceProblem
    from nrs_design.design.laws.law import Task
    from nrs_design.proof.system import SwitchedSystem

Array = NDArray[np.float64]
# A virtual mass that may be zero is zero, or at least this share of the largest.
LEAST_MASS = Fraction(1, 1000)
MOST_KNOWN = 64  # Points whose problems are cached
MISSED = 1e-6  # Tolerance of a goal in floating point


@dataclass(frozen=True, eq=False)
class RoundedGains:
    """Gains near a point as a spec may give them."""

    x: Array  # The point that they are
    # By controller and name: in the units of the design, and as a spec writes them.
    gains: Mapping[tuple[str, str], tuple[Fraction, str]]

    @property
    def written(self) -> Written:
        """Texts of the gains in a spec."""
        return {name: text for name, (_, text) in self.gains.items()}


@dataclass(frozen=True, eq=False)
class FreeGains:
    """The free gains of a design: without virtual masses, or with them."""

    designed: Designed  # With the other gains
    analysis: DesignAnalysis
    massless: bool

    @cached_property
    def coordinates(self) -> tuple[GainCoordinate, ...]:
        """The gains that are chosen."""
        found: list[GainCoordinate | None] = []
        for item in self.analysis.impedance:
            units = self.designed.design.units[item.name]
            Mt, Bt = item.given.Mt, item.given.Bt
            if not self.massless:
                lowest = Mt.min.exact or LEAST_MASS * Mt.max.exact
                found.append(bounded_gain(item.name, "Mt", Mt, lowest, units["Mt"]))
            found.append(bounded_gain(item.name, "Bt", Bt, Bt.min.exact, units["Bt"]))
        found += freed_gains(self.designed)
        return tuple(one for one in found if one is not None)

    @cached_property
    def low(self) -> Array:
        """Lowest coordinates of a point."""
        return np.array([one.ends[0] for one in self.coordinates])

    @cached_property
    def high(self) -> Array:
        """Highest coordinates of a point."""
        return np.array([one.ends[1] for one in self.coordinates])

    def optimum(self) -> Array:
        """Return the point of the least cost, whatever a proof shows of it.

        Gains that ``design.free`` names are looked at near what the spec gives.
        """
        from nrs_design.design.constrained import optimize_with_goals

        best = {
            item.name: optimize_with_goals(self._bounded(item.problem), item.requirement)
            for item in self.analysis.impedance
        }
        values = (
            float(one.given) if one.given else getattr(best[one.controller], one.gain)
            for one in self.coordinates
        )
        found = np.clip(np.log([*values]), self.low, self.high)
        return self._cheapest_near(found) if self._moves_cost.any() else np.asarray(found)

    def gains(self, x: Array) -> dict[str, dict[str, float]]:
        """Return the gains of every controller at a point, in SI units."""
        laws = self.designed.design.laws
        found = {
            name: {gain: float(value) for gain, value in law.gains.items()}
            for name, law in laws.items()
        }
        for item in self.analysis.impedance:
            Mt, Bt = item.given.Mt, item.given.Bt
            found[item.name]["Mt"] = 0.0 if self.massless else Mt.min.si
            found[item.name]["Bt"] = Bt.min.si
        for one, value in zip(self.coordinates, x, strict=True):
            found[one.controller][one.gain] = one.value(float(value))
        return found

    def cost(self, x: Array) -> float:
        """Return the cost at a point, summed over the impedance controllers."""
        return sum(self.costs(x).values())

    def costs(self, x: Array) -> dict[str, float]:
        """Return the cost of each impedance controller at a point."""
        from nrs_design.design.impedance_optimum import impedance_cost

        # Most gains change no problem, and a search repeats the same few points.
        problems = known_problems(self, tuple(np.where(self._moves_cost, x, self.low)))
        gains, costs = self.gains(x), {}
        for item, problem in zip(self.analysis.impedance, problems, strict=True):
            values = gains[item.name]
            costs[item.name] = float(impedance_cost(problem, values["Mt"], values["Bt"]))
        return costs

    def spared(self, x: Array) -> Array:
        """Return for each controller with goals by how much they are met; negative if missed."""
        gains, margins = self.gains(x), []
        for item in self.analysis.impedance:
            if item.requirement.goals:
                own = (np.array([gains[item.name][gain]]) for gain in BOUNDED)
                margins.append(-self._requirement(item, x).violation(*own)[0])
        margins += self._spared_by_others(x)
        return np.asarray(np.maximum(np.array(margins, dtype=float), -1.0))

    def design(self, x: Array) -> ControllerDesign:
        """Return the design with the single-precision gains next to a point."""
        return self._design(x, round_float32)

    def _design(self, x: Array, rounding: Callable[[Fraction], Fraction]) -> ControllerDesign:
        gains = {
            name: {gain: rounding(Fraction(value)) for gain, value in values.items()}
            for name, values in self.gains(x).items()
        }
        return self.designed.design.replace_gains(gains)

    def system(self, x: Array) -> SwitchedSystem:
        """Assemble the modes with the single-precision gains next to a point."""
        designed = replace(self.designed, design=self.design(x))
        return assemble_spec(designed.loaded, designed)

    def roundings(self, x: Array) -> Iterator[RoundedGains]:
        """Yield points near one as a spec may give them."""
        digits = self.designed.spec.design.significant_digits
        zeros = {
            (item.name, gain): (Fraction(0), f"0 {unit('kg*m^2')}")
            for item in self.analysis.impedance
            for gain in BOUNDED
            if not getattr(item.given, gain).fixed
        }
        pairs = zip(self.coordinates, x, strict=True)
        for neighbors_of_x in product(*(one.near(float(value), digits) for one, value in pairs)):
            gains = dict(zip((one.name for one in self.coordinates), neighbors_of_x, strict=True))
            point = np.log([float(value) for value, _ in neighbors_of_x])
            yield RoundedGains(point, zeros | gains)

    def holds(self, design: ControllerDesign) -> bool:
        """Tell whether a design has masses where these gains have some, and none where not."""
        masses = (design.laws[item.name].gains["Mt"] for item in self.analysis.impedance)
        return all((mass == 0) == self.massless for mass in masses)

    def of(self, design: ControllerDesign) -> RoundedGains:
        """Return the gains of a design, with as few digits as possible."""
        laws = design.laws
        own = {one.name: laws[one.controller].gains[one.gain] for one in self.coordinates}
        point = np.log([float(value) for value in own.values()])
        for near in self.roundings(point):
            if self.shipping(near, point) == design:
                return near
        units = {one.name: one.unit for one in self.coordinates}
        return RoundedGains(point, {n: (v, f"{exact_text(v)} {units[n]}") for n, v in own.items()})

    def shipping(self, one: RoundedGains, x: Array) -> ControllerDesign:
        """Return the design that ships of a rounding of a point."""
        from nrs_design.controllers.controller_design import ImpedanceOptimum

        chosen: dict[str, dict[str, Fraction]] = {}
        for (name, gain), (value, _) in one.gains.items():
            chosen.setdefault(name, {})[gain] = round_float32(value)
        found, gains, costs = (
            self.designed.design.replace_gains(chosen),
            self.gains(x),
            self.costs(x),
        )
        for own, value in zip(self.coordinates, x, strict=True):
            gains[own.controller][own.gain] = own.settled(float(value))
        best = {
            name: ImpedanceOptimum(gains[name]["Mt"], gains[name]["Bt"], cost)
            for name, cost in costs.items()
        }
        controllers = (replace(c, optimum=best.get(c.name)) for c in found.controllers)
        return replace(found, controllers=tuple(controllers))

    def said(self, x: Array) -> str:
        """Write the impedance gains and the free gains at a point."""
        gains, units = self.gains(x), self.designed.design.units
        rows = {item.name: dict.fromkeys(BOUNDED) for item in self.analysis.impedance}
        for one in self.coordinates:
            rows.setdefault(one.controller, {})[one.gain] = None
        texts = []
        for name, names in rows.items():
            pairs = ((gain, units[name][gain].replace("*", " ")) for gain in names)
            of_one = ", ".join(f"{gain} = {gains[name][gain]:.4g} {unit}" for gain, unit in pairs)
            texts.append(f"{name} {of_one}")
        return "; ".join(texts)

    def at_bounds(self, x: Array) -> tuple[tuple[str, str], ...]:
        """Return the gains freed by factors that are on a bound, and on which."""
        pairs = zip(self.coordinates, x, strict=True)
        found = {" ".join(one.name): one.at_bound(float(value)) for one, value in pairs}
        return tuple((name, bound) for name, bound in found.items() if bound is not None)

    @cached_property
    def _moves_cost(self) -> NDArray[np.bool_]:
        """Mask of coordinates that change the cost, beside Mt and Bt."""
        costing = {item.name for item in self.analysis.impedance}
        costing |= {MOTION} if costing else set()
        moves = [one.given is not None and one.controller in costing for one in self.coordinates]
        return np.array(moves, dtype=bool)

    def _bounded(self, problem: ImpedanceProblem) -> ImpedanceProblem:
        low, high = problem.mass_bounds
        least = low or float(LEAST_MASS) * high
        return replace(problem, mass_bounds=(0.0, 0.0) if self.massless else (least, high))

    def problems(self, x: Array) -> Iterator[ImpedanceProblem]:
        """Yield the problem of each impedance controller at the other gains of a point."""
        from nrs_design.design.laws.impedance import impedance_problem

        design = self._design(x, Fraction)
        for item in self.analysis.impedance:
            problem = impedance_problem(self._task(design), item.given, item.requirement)
            # The spring of the spec is a single-precision number, and has no slope.
            Kt = float(design.laws[item.name].gains.get("Kt", 0))
            yield self._bounded(replace(problem, loop=replace(problem.loop, Kt=Kt)))

    def _requirement(self, item: ImpedanceAnalysis, x: Array) -> Requirement:
        """Return the goals of an impedance controller at the other gains of a point."""
        from nrs_design.design.laws.impedance import requirement_of, with_spring

        if not self._moves_cost.any():
            return item.requirement
        design = self._design(x, Fraction)
        spring = design.laws[item.name].gains.get("Kt")
        return requirement_of(self._task(design), with_spring(item.given, spring))

    def _task(self, design: ControllerDesign) -> Task:
        from nrs_design.design.laws.law import Task

        return Task(self.designed.spec, self.designed.plant, design.motion)

    def _cheapest_near(self, start: Array) -> Array:
        """Descend from a start, where goals of controllers stay met."""
        from nrs_design.design.trust_region import cheapest

        optimum = cheapest(self.cost, self.spared, self.low, self.high, start)
        better = self.cost(optimum) < self.cost(start) and (self.spared(optimum) >= -MISSED).all()
        return optimum if better else start

    def _spared_by_others(self, x: Array) -> list[float]:
        """Return the margins of goals of controllers with or after freed gains."""
        from nrs_design.design.laws import LAW_DESIGNS

        controllers = {one.controller for one in self.coordinates if one.given is not None}
        spared, design = [], self._design(x, Fraction)
        for item in self.analysis.tuned:
            goals = any(found.goal is not None for found in item.achieved)
            if not goals or controllers.isdisjoint({MOTION, item.name}):
                continue
            (controller,) = (c for c in design.controllers if c.name == item.name)
            given = self.designed.spec.controllers[item.name]
            analyze = LAW_DESIGNS[controller.law.name].analyze
            assert analyze is not None, "as it has been analyzed"
            try:
                found = analyze(self._task(design), given, controller)
            except DesignError:  # Nominal contact is not stable.
                spared.append(-1.0)
                continue
            missed = (a.measure.violation(a.value, a.goal) for a in found.achieved if a.goal)
            spared.append(-max(missed))
        return spared


@lru_cache(MOST_KNOWN)
def known_problems(gains: FreeGains, x: tuple[float, ...]) -> tuple[ImpedanceProblem, ...]:
    """Return the problems at a point of gains."""
    return tuple(gains.problems(np.array(x)))


def gain_branches(designed: Designed, analysis: DesignAnalysis) -> Iterator[FreeGains]:
    """Yield the sets of gains to choose from: without virtual masses, and with them."""
    bounds = tuple(item.problem.mass_bounds for item in analysis.impedance)
    if not any(low == 0 < high for low, high in bounds):
        yield FreeGains(designed, analysis, massless=not any(high for _, high in bounds))
        return
    if all(low == 0 for low, _ in bounds):
        yield FreeGains(designed, analysis, massless=True)
    if all(high > 0 for _, high in bounds):
        yield FreeGains(designed, analysis, massless=False)


def add_problems(designed: Designed, analysis: DesignAnalysis) -> DesignAnalysis:
    """Return what gains are optimized for under another spec than that of an analysis.

    What its own gains achieve is not asked: others are to be chosen, and these may be unstable.
    """
    from nrs_design.design.laws.impedance import impedance_problem, requirement_of
    from nrs_design.design.laws.law import Task

    task, items = Task(designed.spec, designed.plant, designed.design.motion), []
    for item in analysis.impedance:
        requirement = requirement_of(task, item.given)
        problem = impedance_problem(task, item.given, requirement)
        items.append(replace(item, problem=problem, requirement=requirement))
    return replace(analysis, measured=(*items, *analysis.tuned))
