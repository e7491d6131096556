"""Gains that were designed, as floats with units, and what they achieve."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

from nrs_design import pipeline
from nrs_design.errors import DesignError

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class Optimum:
    """The design of a spec.

    Parameters
    ----------
    designed : nrs_design.pipeline.Designed
        The spec with its plant and gains.
    """

    designed: pipeline.Designed

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
    def margins(self) -> dict[str, dict[str, float]]:
        """Worst values over the corners of all ranges, by controller and goal, in SI.

        Floating point, not a proof; see `nrs-design explain margins`.
        """
        analysis = pipeline.run_analysis(self.designed)
        return {
            item.name: {found.measure.goal: float(found.value) for found in item.achieved}
            for item in analysis.measured
        }

    @cached_property
    def cost(self) -> dict[str, float]:
        """The cost of displayed impedance and sensitivity, by impedance controller."""
        analysis = pipeline.run_analysis(self.designed)
        return {item.name: float(item.cost) for item in analysis.impedance}

    def plot(self, name: str = "displayed-impedance") -> Figure:
        """Return a figure of the design by name.

        Raises
        ------
        DesignError
            If there is no figure of that name; the message lists those that there are.
        """
        from nrs_design.reporting.document import Illustration
        from nrs_design.reporting.sections.design import design_sections

        sections = design_sections(self.designed, pipeline.run_analysis(self.designed))
        found = {
            block.name: block.figure
            for section in sections
            if section is not None
            for block in section.blocks
            if isinstance(block, Illustration)
        }
        if name not in found:
            raise DesignError(
                f"there is no figure {name!r}", remedy=f"figures here: {', '.join(found)}"
            )
        return found[name]

    def to_dict(self) -> dict[str, Any]:
        """Return gains, units, margins and costs, in SI."""
        return {
            "gains": self.gains,
            "units": self.units,
            "margins": self.margins,
            "cost": self.cost,
        }

    def _rows(self) -> list[tuple[str, str]]:
        return [
            (name, ", ".join(f"{k} = {v:.6g} {self.units[name][k]}".rstrip() for k, v in g.items()))
            for name, g in self.gains.items()
        ]

    def __repr__(self) -> str:
        """Name the spec."""
        return f"<Optimum of {self.designed.spec.name}>"

    def __str__(self) -> str:
        """Say the gains."""
        return "\n".join(f"{name}: {gains}" for name, gains in self._rows())

    def _repr_html_(self) -> str:
        """Show the gains in a notebook."""
        rows = "".join(
            f"<tr><th>{escape(name)}</th><td>{escape(gains)}</td></tr>"
            for name, gains in self._rows()
        )
        return f"<table>{rows}</table>"
