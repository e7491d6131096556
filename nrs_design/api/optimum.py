"""Gains that were designed, as floats with units, and what they achieve."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from nrs_design.api.result import AbstractResult, Figures, drawn
from nrs_design.facts.design import finite, optimum_facts
from nrs_design.pipeline.design import Designed, run_analysis

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis


@dataclass(frozen=True, repr=False)
class Optimum(AbstractResult):
    """The design of a spec.

    Parameters
    ----------
    designed : nrs_design.pipeline.design.Designed
        The spec with its plant and gains.
    """

    designed: Designed

    @property
    def gains(self) -> dict[str, dict[str, float]]:
        """Gains by controller and name; the doubles of the single-precision numbers that ship."""
        controllers = self.designed.design.controllers
        found = {item.name: item.law.gains for item in controllers}
        return {
            name: {gain: float(value) for gain, value in gains.items()}
            for name, gains in found.items()
        }

    @property
    def units(self) -> dict[str, dict[str, str]]:
        """Their units, by the same keys."""
        known = self.designed.design.units
        return {
            name: {gain: known.get(name, {}).get(gain, "") for gain in gains}
            for name, gains in self.gains.items()
        }

    @cached_property
    def _analysis(self) -> DesignAnalysis:
        return run_analysis(self.designed)

    @property
    def margins(self) -> dict[str, dict[str, float]]:
        """Worst values over the corners of all ranges, by controller and goal, in SI.

        Floating point, not a proof; see `nrs-design explain margins`.
        """
        return {
            item.name: {found.measure.goal: float(found.value) for found in item.achieved}
            for item in self._analysis.measured
        }

    @property
    def cost(self) -> dict[str, float]:
        """The cost of displayed impedance and sensitivity, by impedance controller."""
        return {item.name: float(item.cost) for item in self._analysis.impedance}

    def drawings(self) -> Figures:
        """Return the figures of the design by name."""
        from nrs_design.reporting.sections.design import design_sections

        sections = design_sections(self.designed, self._analysis)
        return drawn(sections, "displayed-impedance")

    def gain_rows(self) -> Iterator[tuple[str, str, str, str]]:
        """Return controller, gain, value and unit of each gain."""
        for name, gains in self.gains.items():
            for gain, value in gains.items():
                yield name, gain, f"{value:.6g}", self.units[name][gain]

    def _axis(self) -> object:
        return self.designed.spec.axis

    def _facts(self) -> dict[str, Any]:
        analysis = self._analysis
        return {
            **self.designed.loaded.facts,
            **optimum_facts(self.designed, analysis),
            "warnings": [str(doubt) for doubt in analysis.warnings],
            "gains": self.gains,
            "units": self.units,
            # JSON has no infinity: null is what nothing limits.
            "margins": {name: _finite(found) for name, found in self.margins.items()},
            "cost": _finite(self.cost),
        }

    def _drawings(self) -> Figures:
        return self.drawings()

    def _headline(self) -> str:
        return f"{self.designed.spec.name}: designed gains"

    def _rows(self) -> Iterator[Sequence[str]]:
        yield "controller", "gain", "value", "unit"
        yield from self.gain_rows()

    def __str__(self) -> str:
        """Say the gains."""
        lines = []
        for name, gains in self.gains.items():
            if not gains:
                lines.append(f"{name}: no gain, the motion loop alone")
                continue
            units = self.units[name]
            shown = (f"{gain} = {value:.6g} {units[gain]}" for gain, value in gains.items())
            lines.append(f"{name}: {', '.join(text.rstrip() for text in shown)}")
        return "\n".join(lines)


def _finite(values: Mapping[str, float]) -> dict[str, float | None]:
    return {name: finite(value) for name, value in values.items()}
