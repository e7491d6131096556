"""The worst runs that an adversary found, as the library gives them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from nrs_design.api.result import AbstractResult, Figures
from nrs_design.pipeline.design import Designed

if TYPE_CHECKING:
    from nrs_design.pipeline.scenarios import WorstCase
    from nrs_design.simulation.worst_case import WorstRun


@dataclass(frozen=True, repr=False)
class WorstFound(AbstractResult):
    """What an adversary found: a lower bound of the worst that may happen in the model."""

    designed: Designed  # The spec and its gains
    case: WorstCase  # His runs

    @property
    def runs(self) -> tuple[WorstRun, ...]:
        """One for each quantity: force, velocity and deflection."""
        return self.case.runs

    @property
    def worst(self) -> dict[str, float]:
        """The worst value that was found of each quantity, in SI."""
        return {run.output.name: run.value for run in self.runs}

    @property
    def limits(self) -> Mapping[str, float]:
        """Limits of the quantities, as far as the spec has any, in SI."""
        return self.case.limits

    @property
    def bounds(self) -> Mapping[str, float]:
        """Certified bounds of the quantities, in SI."""
        return self.case.bounds

    @property
    def declared(self) -> bool:
        """True if the spec declares disturbances; else any command up to its limit disturbs."""
        return self.case.declared

    def _axis(self) -> object:
        return self.designed.spec.axis

    def _facts(self) -> dict[str, Any]:
        from nrs_design.reporting.worst_case import LEFT_OUT

        case = self.case
        facts = {
            "disturbances": [
                {"name": c.name, "unit": c.unit, "bound": float(c.bound)}
                for c in case.system.channels
            ],
            "disturbances_declared": case.declared,
            "found": case.found,
            "not_modelled": [LEFT_OUT],
        }
        return self.designed.loaded.facts | {"worst_case": facts, "files": []}

    def _drawings(self) -> Figures:
        from nrs_design.reporting.worst_case import draw_worst

        spec = self.designed.spec
        return [(run.output.name, partial(draw_worst, self.case, run, spec)) for run in self.runs]

    def _headline(self) -> str:
        return f"{self.designed.spec.name}: the worst that was found, a lower bound"

    def _rows(self) -> Iterator[Sequence[str]]:
        from nrs_design.reporting.worst_case import COLUMNS, worst_rows

        yield COLUMNS
        yield from worst_rows(self.case, self.designed.spec)
