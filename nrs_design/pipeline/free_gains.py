"""The gains of all impedance controllers that a spec leaves free, as one point to be chosen.

A point holds their logarithms. Of its gains, either all virtual masses are zero, or none: they are
different laws.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
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
from nrs_design.pipeline.certification import assemble_spec, gains_text, is_of_gains
from nrs_design.pipeline.design import Designed, run_design
from nrs_design.proof.text import exact_text
from nrs_design.spec import LoadedSpec
from nrs_design.spec.document import parse_document
from nrs_design.spec.load import respecified
from nrs_design.spec.spec_document import SpecDocument

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Gains
    from nrs_design.design.analysis import DesignAnalysis, ImpedanceAnalysis
    from nrs_design.design.impedance_optimum import ImpedanceProblem
    from nrs_design.models.plant import Plant
    from nrs_design.proof.system import SwitchedSystem

Array = NDArray[np.float64]
# What ships of every free gain, with its unit, by controller and name.
Written = Mapping[tuple[str, str], str]

# A virtual mass that may be zero is zero, or at least this share of the largest.
LEAST_MASS = 1e-3
# A logarithm that is nearer to that of a bound is at the bound.
CLOSE = 1e-6
UNITS = {"Mt": "kg*m^2", "Bt": "N*m*s/rad"}


@dataclass(frozen=True)
class FreeGains:
    """The free gains of a design, within bounds for the virtual masses."""

    designed: Designed  # With the other gains
    items: tuple[ImpedanceAnalysis, ...]  # What each controller is optimized for
    masses: tuple[tuple[float, float], ...]  # Bounds of each Mt, kg m^2

    @cached_property
    def problems(self) -> tuple[ImpedanceProblem, ...]:
        """What each controller is optimized for, within these bounds."""
        pairs = zip(self.items, self.masses, strict=True)
        return tuple(replace(item.problem, mass_bounds=mass) for item, mass in pairs)

    @cached_property
    def bounds(self) -> tuple[dict[str, tuple[float, float]], ...]:
        """Ends of each gain, SI units."""
        return tuple({"Mt": p.mass_bounds, "Bt": p.damping_bounds} for p in self.problems)

    @cached_property
    def places(self) -> tuple[tuple[int, str], ...]:
        """Controller and name of each coordinate of a point."""
        return tuple(
            (k, name)
            for k, own in enumerate(self.bounds)
            for name, (low, high) in own.items()
            if low < high
        )

    @cached_property
    def low(self) -> Array:
        """Lowest coordinates of a point."""
        return np.log([self.bounds[k][name][0] for k, name in self.places])

    @cached_property
    def high(self) -> Array:
        """Highest coordinates of a point."""
        return np.log([self.bounds[k][name][1] for k, name in self.places])

    def optimum(self) -> Array:
        """Return the point of the least cost, whatever a proof shows of it.

        Raises
        ------
        DesignError
            If no gains within the bounds meet the goals of a controller.
        """
        from nrs_design.design.constrained import optimize_with_goals

        best = [
            optimize_with_goals(problem, item.requirement)
            for problem, item in zip(self.problems, self.items, strict=True)
        ]
        found = np.log([getattr(best[k], name) for k, name in self.places])
        return np.asarray(np.clip(found, self.low, self.high))

    def gains(self, x: Array) -> list[dict[str, float]]:
        """Return Mt and Bt of every controller at a point, in SI units."""
        found = [{name: low for name, (low, _) in own.items()} for own in self.bounds]
        for (k, name), value, low, high in zip(self.places, x, self.low, self.high, strict=True):
            found[k][name] = exp(min(max(value, low), high))
        return found

    def cost(self, x: Array) -> float:
        """Return the cost at a point, summed over the controllers."""
        from nrs_design.design.impedance_optimum import impedance_cost

        pairs = zip(self.problems, self.gains(x), strict=True)
        return sum(float(impedance_cost(problem, own["Mt"], own["Bt"])) for problem, own in pairs)

    def spared(self, x: Array) -> Array:
        """Return for each controller with goals by how much they are met; negative if missed."""
        met = [
            -item.requirement.violation(np.array([own["Mt"]]), np.array([own["Bt"]]))[0]
            for item, own in zip(self.items, self.gains(x), strict=True)
            if item.requirement.goals
        ]
        return np.asarray(np.maximum(np.array(met, dtype=float), -1.0))

    def system(self, x: Array, plant: Plant | None = None) -> SwitchedSystem:
        """Assemble the modes with the single-precision gains next to a point.

        Parameters
        ----------
        x : ndarray
            The point.
        plant : Plant, optional
            By default that of the spec.

        Raises
        ------
        AssemblyError
            If they make no switched system.
        """
        from nrs_design.controllers.gains import design_from_gains

        gains = {name: dict(own) for name, own in gains_text(self.designed).items()}
        for item, own in zip(self.items, self.gains(x), strict=True):
            for name, value in own.items():
                gains[item.name][name] = exact_decimal(to_float32(Fraction(value)))
        design = design_from_gains(self.designed.spec, gains)
        designed = replace(self.designed, design=design, plant=plant or self.designed.plant)
        return assemble_spec(designed.loaded, designed, designed.spec.coordinates)

    def roundings(self, x: Array) -> Iterator[tuple[Array, Written]]:
        """Yield points near one as a spec may give them, and what it says then.

        Parameters
        ----------
        x : ndarray
            The point.
        """
        for near in product(*(self._near(i, value) for i, value in enumerate(x))):
            texts = dict(zip(self.places, (text for _, text in near), strict=True))
            written = {
                (item.name, name): texts.get((k, name), f"0 {unit(UNITS[name])}")
                for k, item in enumerate(self.items)
                for name in free_names(item)
            }
            yield np.log([value for value, _ in near]), written

    def _near(self, i: int, x: float) -> list[tuple[float, str]]:
        """Return values near a gain: its bound, or a few digits."""
        k, name = self.places[i]
        given = getattr(self.items[k].given, name)
        for end in (given.min, given.max):
            if end.exact > 0 and abs(x - log(end.si)) < CLOSE:
                return [(end.si, end.text)]
        digits = self.designed.spec.design.significant_digits
        found = {round_significant(near, digits) for near in neighbors(exp(x), digits)}
        inside = [v for v in found if given.min.exact <= v <= given.max.exact and v > 0]
        return [(float(v), f"{exact_text(v)} {unit(UNITS[name])}") for v in sorted(inside)]

    def respecified(
        self, written: Written, change: Callable[[SpecDocument], None] = lambda document: None
    ) -> LoadedSpec:
        """Return the spec with gains given, and its text; ranges of gains stay.

        Parameters
        ----------
        written : mapping
            The gains.
        change : callable
            Changes the document further.

        Raises
        ------
        SpecError
            If that is no valid spec, or a comment would be lost.
        """
        loaded = self.designed.loaded
        document = SpecDocument(loaded)
        for (controller, name), text in written.items():
            given = getattr(self.designed.spec.controllers[controller], name)
            ends = None if given.range is None else [end.text for end in given.range]
            said = text if ends is None else {"nominal": text, "range": ends}
            document.put(document.root["controllers"][controller], name, said)
        change(document)
        text = document.text()
        return replace(respecified(loaded, parse_document(text, loaded.path)), text=text)

    def said(self, x: Array) -> str:
        """Write the gains at a point for people."""
        return "; ".join(
            f"{item.name} Mt = {own['Mt']:.4g} {unit('kg m^2')}, Bt = {own['Bt']:.4g} "
            f"{unit('N m s/rad')}"
            for item, own in zip(self.items, self.gains(x), strict=True)
        )


def free_names(item: ImpedanceAnalysis) -> tuple[str, ...]:
    """Return which gains of a controller the spec leaves free."""
    return tuple(name for name in UNITS if not getattr(item.given, name).fixed)


def gain_branches(designed: Designed, analysis: DesignAnalysis) -> Iterator[FreeGains]:
    """Yield the sets of gains to choose from: without virtual masses, and with them.

    Parameters
    ----------
    designed, analysis
        The spec, and what its design achieves.
    """
    items = analysis.impedance
    bounds = tuple(item.problem.mass_bounds for item in items)
    if not any(low == 0 < high for low, high in bounds):
        yield FreeGains(designed, items, bounds)
        return
    if all(low == 0 for low, _ in bounds):
        yield FreeGains(designed, items, ((0.0, 0.0),) * len(items))
    if all(high > 0 for _, high in bounds):
        above = tuple((low or LEAST_MASS * high, high) for low, high in bounds)
        yield FreeGains(designed, items, above)


def check_own_gains(loaded: LoadedSpec, gains: Gains) -> None:
    """Refuse a spec that by itself would be designed with other gains.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec of some tile, which a certificate is to be written with.
    gains : mapping
        Those of the certificate, as `gains_text` gives them.

    Raises
    ------
    DesignError
        If its own gains are others, or it has none.
    """
    if not is_of_gains(gains, run_design(loaded)):
        raise DesignError(
            "gains of this spec follow from what the map changes, so no spec has the gains of "
            "its certificates",
            path=loaded.path,
            remedy="give these gains in the spec, or leave --certificates out",
        )


def gains_given(designed: Designed) -> LoadedSpec:
    """Return the spec with all gains that it leaves free given as they ship, and its text.

    Raises
    ------
    SpecError
        If a comment would be lost.
    """
    loaded, document = designed.loaded, SpecDocument(designed.loaded)
    laws, units = designed.design.laws, designed.design.units
    for controller, given in designed.spec.controllers.items():
        for name, gain in given.gains().items():
            if gain.fixed:
                continue
            # The shortest decimal that single precision holds as this very number.
            value = f"{np.float32(float(laws[controller].gains[name]))} {units[controller][name]}"
            ends = None if gain.range is None else [end.text for end in gain.range]
            said = value if ends is None else {"nominal": value, "range": ends}
            document.put(document.root["controllers"][controller], name, said)
    text = document.text()
    return replace(respecified(loaded, parse_document(text, loaded.path)), text=text)


def has_free_gains(analysis: DesignAnalysis) -> bool:
    """Tell whether an impedance controller has a gain to choose."""
    return any(free_names(item) for item in analysis.impedance)


def in_order(
    choices: Sequence[tuple[tuple[float, ...], Array, Written]],
) -> list[tuple[Array, Written]]:
    """Return points and what is written of them, the best first.

    Parameters
    ----------
    choices : sequence of (tuple, ndarray, mapping)
        What counts against each, the point, and what is written.
    """
    ranked = sorted(choices, key=lambda item: (*item[0], *map(float, item[1])))
    return [(x, written) for _, x, written in ranked]
