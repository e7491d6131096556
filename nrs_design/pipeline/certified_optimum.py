"""The cheapest gains whose proof meets the goals of a certificate: all controllers jointly.

The cost is that of `nrs_design.design.impedance_optimum`, summed over the controllers. What a
proof shows is known at a design, with its slope (`nrs_design.search.rate_slope`); between two
designs it is taken as linear in the logarithms of the gains, within a region that shrinks where
that was wrong. Gains are rounded to the digits that ship, and the proof of these is searched and
checked as that of any spec.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import product
from math import exp, log
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from nrs_design.axis import unit
from nrs_design.controllers.float32 import (
    exact_decimal,
    neighbors,
    round_significant,
    to_float32,
)
from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import (
    Result,
    assemble_spec,
    gains_text,
    run_certification,
    search_limits,
)
from nrs_design.pipeline.design import Designed, placed
from nrs_design.progress import Progress, silent
from nrs_design.proof.bounds import rounded_up
from nrs_design.proof.text import exact_text
from nrs_design.spec import LoadedSpec
from nrs_design.spec.document import parse_document
from nrs_design.spec.load import respecified
from nrs_design.spec.spec_document import SpecDocument
from nrs_design.work import Allowance, Fuse, NotAffordableError

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis, ImpedanceAnalysis
    from nrs_design.design.steered_search import Look, Steered, SteeredProblem
    from nrs_design.proof.system import SwitchedSystem

Array = NDArray[np.float64]

# Goals that gains are steered by.
STEERING = ("decay_rate",)
# Of a rate that is asked for, so much more is sought: roundings take a little.
ROOM = 5e-4
# How far the logarithm of a gain moves for a slope.
STEP = 1e-3
# Roundings that are proved at most.
MOST_ROUNDINGS = 4
# A virtual mass that may be zero is zero, or at least this share of the largest.
LEAST_MASS = 1e-3
# A goal with less than this share to spare binds.
NEAR = 5e-3
# A logarithm that is nearer to that of a bound is at the bound.
CLOSE = 1e-6
UNITS = {"Mt": "kg*m^2", "Bt": "N*m*s/rad"}


@dataclass(frozen=True, slots=True)
class SteeredGoal:
    """A goal of the certificate that gains were chosen by."""

    key: str  # In the spec
    wanted: Fraction  # In SI units
    text: str  # As the spec writes it
    found: float  # In floating point, before gains are rounded
    # What one more in SI units costs, in first order; None where the goal does not bind.
    price: float | None


@dataclass(frozen=True, slots=True)
class CertifiedOptimum:
    """The gains that were found, with their proof."""

    result: Result  # Of the spec with these gains; its certificate has been checked exactly
    gains: Mapping[tuple[str, str], str]  # By controller and name: what ships, with units
    cost: float  # Summed over the controllers
    free_cost: float  # The least without goals of the certificate
    free_rate: float  # The best decay rate there in floating point, 1/s
    goals: tuple[SteeredGoal, ...]
    tried: int  # Designs whose rate was found


def steering_goals(designed: Designed, analysis: DesignAnalysis) -> tuple[str, ...]:
    """Return the goals that gains can be steered by; none where no gain is free.

    Parameters
    ----------
    designed, analysis
        The spec, and what its design achieves.
    """
    goals = designed.spec.goals
    free = any(_free_names(item) for item in analysis.impedance)
    given = [] if goals is None or not free else [key for key, _ in goals.given()]
    return tuple(key for key in STEERING if key in given)


def run_certified_optimum(
    designed: Designed,
    analysis: DesignAnalysis,
    progress: Progress = silent,
    name: str | None = None,
) -> CertifiedOptimum:
    """Choose virtual mass and damping of all controllers at once, with their proof.

    Where a mass may be zero, the best without masses and the best with them are compared: without,
    a force acts at once, else a sample later.

    Parameters
    ----------
    designed, analysis
        The spec, and what its free optimum achieves. At least one goal steers.
    progress : callable
        Told what is done.
    name : str, optional
        What the spec with these gains is called; by default as it is.

    Raises
    ------
    DesignError
        If no gains within the bounds are proved to meet the goals; it names the nearest.
    AssemblyError
        If the modes make no switched system.
    """
    from nrs_design.search.rate_slope import may_have_slope

    with placed(designed.loaded):
        _check_delay(designed)
        if not may_have_slope(assemble_spec(designed.loaded, designed, designed.spec.coordinates)):
            raise DesignError(
                "gains are chosen with their proof only where one quadratic function may be one: "
                "not with two periods, rules that lead through unstable modes, or one state",
                remedy="leave goals.decay_rate out, and certify what is optimized without it",
                at=("goals", STEERING[0]),
            )
        found, missed = [], []
        for branch in _branches(designed, analysis, name):
            try:
                found.append(branch.run(progress))
            except DesignError as error:
                missed.append(error)
        if not found:
            raise missed[0]
        return min(found, key=lambda item: item.cost)


def _free_names(item: ImpedanceAnalysis) -> tuple[str, ...]:
    return tuple(name for name in ("Mt", "Bt") if not getattr(item.given, name).fixed)


def _check_delay(designed: Designed) -> None:
    """Refuse a delay that the spec does not declare: no gains change that."""
    goals, sampling = designed.spec.goals, designed.spec.sampling
    if goals is None or goals.delay is None or sampling is None:
        return
    if sampling.oldest < goals.delay.exact:
        raise DesignError(
            f"the goal delay, {goals.delay.text}, is beyond what the spec declares: force samples "
            f"are at most {rounded_up(sampling.oldest, 's')} old",
            remedy="declare a longer sampling.delay, or relax the goal",
            at=("goals", "delay"),
        )


def _branches(designed: Designed, analysis: DesignAnalysis, name: str | None) -> Iterator[_Branch]:
    """Yield the sets of gains that are searched: without virtual masses, and with them."""
    items = analysis.impedance
    bounds = [item.problem.mass_bounds for item in items]
    if any(low == 0 < high for low, high in bounds):
        if all(low == 0 for low, _ in bounds):
            yield _Branch(designed, items, [(0.0, 0.0)] * len(items), name)
        if all(high > 0 for _, high in bounds):
            above = [(low or LEAST_MASS * high, high) for low, high in bounds]
            yield _Branch(designed, items, above, name)
    else:
        yield _Branch(designed, items, bounds, name)


class _Branch:
    """The search for gains of which either all virtual masses are zero, or none."""

    def __init__(
        self,
        designed: Designed,
        items: Sequence[ImpedanceAnalysis],
        masses: Sequence[tuple[float, float]],
        name: str | None,
    ) -> None:
        self.designed, self.items, self.name = designed, items, name
        self.problems = [
            replace(item.problem, mass_bounds=mass)
            for item, mass in zip(items, masses, strict=True)
        ]
        bounds = [{"Mt": p.mass_bounds, "Bt": p.damping_bounds} for p in self.problems]
        self.places = [
            (k, name)
            for k, own in enumerate(bounds)
            for name, (low, high) in own.items()
            if low < high
        ]
        ends = [bounds[k][name] for k, name in self.places]
        self.low, self.high = (np.log([end[i] for end in ends]) for i in (0, 1))
        self.fixed = [{name: low for name, (low, _) in own.items()} for own in bounds]
        limits = search_limits(designed.spec)
        self.allowance = Allowance(limits.budget, limits.memory, Fuse.of(limits.budget))
        goals = designed.spec.goals
        assert goals is not None
        assert goals.decay_rate is not None, "the only goal that steers"
        self.goal = goals.decay_rate

    def run(self, progress: Progress) -> CertifiedOptimum:
        """Search, round and prove."""
        from nrs_design.design.steered_search import SteeredProblem, steer

        progress("free optimum")
        free = self._free()
        problem = SteeredProblem(
            self._cost, partial(self._look, progress), self.low, self.high, self._quick
        )
        first = self._look(progress, free, None)
        found = steer(problem, first)
        # What is not reached from one start may be from another: with more damping, or with less.
        for bound in (self.high, self.low):
            if found.last.values[0] > -NEAR:
                break
            other = steer(problem, self._look(progress, (free + bound) / 2, None))
            found = max(found, other, key=lambda one: float(one.last.values[0]))
        value = self._rate(found.last.values[0])
        if found.last.values[0] <= -NEAR:
            raise self._unreachable(found.last.x, value)
        progress("proof")
        result, gains, x = self._proved(found, problem)
        binds = value < self.goal.si * (1 + NEAR)
        price = float(found.prices[0]) / self._scale
        return CertifiedOptimum(
            result,
            gains,
            self._cost(x),
            self._cost(free),
            self._rate(first.values[0]),
            (
                SteeredGoal(
                    "decay_rate", self.goal.exact, self.goal.text, value, price if binds else None
                ),
            ),
            found.looks,
        )

    @property
    def _scale(self) -> float:
        """One of the values of a look, in 1/s."""
        return self.goal.si

    def _rate(self, value: float) -> float:
        """Return the rate in 1/s that a value of a look stands for."""
        return float(value) * self._scale + self.goal.si * (1 + ROOM)

    def _free(self) -> Array:
        """Return the least cost without goals of the certificate."""
        from nrs_design.design.constrained import optimize_with_goals

        best = [
            optimize_with_goals(problem, item.requirement)
            for problem, item in zip(self.problems, self.items, strict=True)
        ]
        found = np.log([getattr(best[k], name) for k, name in self.places])
        return np.asarray(np.clip(found, self.low, self.high))

    def _gains(self, x: Array) -> list[dict[str, float]]:
        """Return Mt and Bt of every controller, in SI units."""
        found = [dict(own) for own in self.fixed]
        for (k, name), value, low, high in zip(self.places, x, self.low, self.high, strict=True):
            found[k][name] = exp(min(max(value, low), high))
        return found

    def _cost(self, x: Array) -> float:
        from nrs_design.design.impedance_optimum import impedance_cost

        pairs = zip(self.problems, self._gains(x), strict=True)
        return sum(float(impedance_cost(problem, own["Mt"], own["Bt"])) for problem, own in pairs)

    def _quick(self, x: Array) -> Array:
        """Return by how much the goals of each controller are met."""
        met = [
            -item.requirement.violation(np.array([own["Mt"]]), np.array([own["Bt"]]))[0]
            for item, own in zip(self.items, self._gains(x), strict=True)
            if item.requirement.goals
        ]
        return np.asarray(np.maximum(np.array(met, dtype=float), -1.0))

    def _system(self, x: Array) -> SwitchedSystem:
        """Assemble the modes with the single-precision gains next to a point."""
        from nrs_design.controllers.gains import design_from_gains

        gains = {name: dict(own) for name, own in gains_text(self.designed).items()}
        for item, own in zip(self.items, self._gains(x), strict=True):
            for name, value in own.items():
                gains[item.name][name] = exact_decimal(to_float32(Fraction(value)))
        design = design_from_gains(self.designed.spec, gains)
        designed = replace(self.designed, design=design)
        return assemble_spec(designed.loaded, designed, designed.spec.coordinates)

    def _look(self, progress: Progress, x: Array, expected: Array | None) -> Look:
        """Find the best decay rate of a design, and let its slope be asked for."""
        from nrs_design.design.steered_search import Look
        from nrs_design.search.rate_slope import rate_slope

        try:
            guess = None if expected is None else self._rate(expected[0])
            found = rate_slope(self._system(x), guess, self.allowance)
        except NotAffordableError as error:
            raise DesignError(
                f"no gains were found: {error}",
                remedy="allow more with certification.budget",
                at=("goals", "decay_rate"),
            ) from error
        if found is None:
            return Look(x, np.array([-1.0]), lambda: np.zeros((1, len(x))))
        progress(f"decay rate {found.rate:.4g} 1/s at cost {self._cost(x):.5g}")
        value = (found.rate - self.goal.si * (1 + ROOM)) / self._scale

        def slopes() -> Array:
            moved = []
            for i in range(len(x)):
                step = STEP if x[i] + STEP <= self.high[i] else -STEP
                there = self._system(x + step * np.eye(len(x))[i])
                moved.append(found.change(there) / step / self._scale)
            return np.array([moved])

        return Look(x, np.array([value]), slopes)

    def _proved(
        self, found: Steered, problem: SteeredProblem
    ) -> tuple[Result, Mapping[tuple[str, str], str], Array]:
        """Round to the digits that ship, the cheapest first, and prove one that meets the goals."""
        from nrs_design.certificates.goals import certified_goals

        last, digits = found.last, self.designed.spec.design.significant_digits
        ranked = []
        for written in product(
            *(self._written(i, value, digits) for i, value in enumerate(last.x))
        ):
            x = np.log([value for value, _ in written])
            missed = problem.penalty(last.values + found.slopes @ (x - last.x))
            wrong = problem.penalty(self._quick(x)) > 0
            texts = tuple(text for _, text in written)
            ranked.append((wrong, missed > 0, self._cost(x) + missed, texts, x))
        for *_, texts, x in sorted(ranked, key=lambda item: item[:4])[:MOST_ROUNDINGS]:
            gains = self._texts(texts)
            result = run_certification(self._respecified(gains))
            goals = certified_goals(result.loaded.spec, result.certificate)
            if all(goal.met for goal in goals if goal.key in STEERING):
                return result, gains, x
        raise DesignError(
            f"no gains of {digits} significant digits near the best ones were proved",
            remedy="raise design.significant_digits (at most 7), or relax a goal",
            at=("goals", "decay_rate"),
        )

    def _written(self, i: int, x: float, digits: int) -> list[tuple[float, str]]:
        """Return values near a gain as a spec may give them: its bound, or a few digits."""
        k, name = self.places[i]
        given = getattr(self.items[k].given, name)
        for end in (given.min, given.max):
            if end.exact > 0 and abs(x - log(end.si)) < CLOSE:
                return [(end.si, end.text)]
        found = {round_significant(near, digits) for near in neighbors(exp(x), digits)}
        inside = [v for v in found if given.min.exact <= v <= given.max.exact and v > 0]
        return [(float(v), f"{exact_text(v)} {unit(UNITS[name])}") for v in sorted(inside)]

    def _texts(self, texts: Sequence[str]) -> dict[tuple[str, str], str]:
        """Return what ships of every gain that the spec leaves free."""
        found = dict(zip(self.places, texts, strict=True))
        return {
            (item.name, name): found.get((k, name), f"0 {unit(UNITS[name])}")
            for k, item in enumerate(self.items)
            for name in _free_names(item)
        }

    def _respecified(self, gains: Mapping[tuple[str, str], str]) -> LoadedSpec:
        """Return the spec with these gains given, and its text; ranges of gains stay."""
        loaded = self.designed.loaded
        document = SpecDocument(loaded)
        for (controller, name), text in gains.items():
            given = getattr(self.designed.spec.controllers[controller], name)
            ends = None if given.range is None else [end.text for end in given.range]
            said = text if ends is None else {"nominal": text, "range": ends}
            document.put(document.root["controllers"][controller], name, said)
        if self.name is not None:
            document.put(document.root, "name", self.name)
        text = document.text()
        return replace(respecified(loaded, parse_document(text, loaded.path)), text=text)

    def _unreachable(self, x: Array, rate: float) -> DesignError:
        """Say how near the goal gains come."""
        gains = "; ".join(
            f"{item.name} Mt = {own['Mt']:.4g} {unit('kg m^2')}, Bt = {own['Bt']:.4g} "
            f"{unit('N m s/rad')}"
            for item, own in zip(self.items, self._gains(x), strict=True)
        )
        return DesignError(
            f"no gains within the bounds were found to be proved with a decay rate of "
            f"{self.goal.text}: the nearest, {gains}, reach {rate:.4g} 1/s",
            remedy="relax the goal, widen the bounds, narrow the ranges, or shorten the delay",
            at=("goals", "decay_rate"),
        )
