"""Runs of the scenarios of a spec, as the library gives them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from nrs_design.api.result import AbstractResult, Figures
from nrs_design.errors import DesignError
from nrs_design.models.axis import unit
from nrs_design.pipeline.design import Designed

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from nrs_design.certificates.certificate import Certificate
    from nrs_design.pipeline.scenarios import CertifiedBound, CertifiedRate, Simulated
    from nrs_design.simulation.run import Run
    from nrs_design.simulation.scenario import Scenario
    from nrs_design.simulation.time_response import Signal, TimeResponse

# Metrics in the table of a run, with the units on a rotary axis.
_TABLE_METRICS = (
    ("peak_torque", "N*m"),
    ("peak_velocity", "rad/s"),
    ("peak_depth", "rad"),
    ("switches", ""),
)


@dataclass(frozen=True, repr=False)
class ScenarioRun(AbstractResult):
    """A scenario that has been simulated: it proves nothing."""

    designed: Designed  # The spec and its gains
    simulated: Simulated
    # bounds, rate: certified bounds and decay rate
    bounds: tuple[CertifiedBound, ...] = ()
    rate: CertifiedRate | None = None

    @property
    def name(self) -> str:
        """Name of the scenario."""
        return self.simulated.scenario.name

    @property
    def scenario(self) -> Scenario:
        """What was simulated, in SI."""
        return self.simulated.scenario

    @property
    def run(self) -> Run:
        """Run of the engine: steps, switches, contacts and the reason of a stop."""
        return self.simulated.run

    @property
    def metrics(self) -> Mapping[str, Any]:
        """Metrics of the run, in SI."""
        return self.simulated.metrics

    @property
    def response(self) -> TimeResponse:
        """All signals over time, as arrays with time last."""
        return self.run.response

    @property
    def time(self) -> NDArray[np.float64]:
        """Instants in s, shape (N,)."""
        return self.response.t

    @property
    def signals(self) -> tuple[Signal, ...]:
        """Names and units of outputs, inputs and states."""
        return (*self.response.outputs, *self.response.inputs, *self.response.states)

    @property
    def units(self) -> dict[str, str]:
        """Units of the signals, by name."""
        return {signal.name: signal.unit for signal in reversed(self.signals)}

    @property
    def active(self) -> list[str]:
        """Name of the controller in force at every instant."""
        return self.response.active

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Return a signal by its name, shape (N,)."""
        if name not in self.units:
            known = ", ".join(signal.name for signal in self.signals)
            raise DesignError(f"there is no signal {name!r}", remedy=f"signals here: {known}")
        return self.response[name]

    def _axis(self) -> object:
        return self.designed.spec.axis

    def _facts(self) -> dict[str, Any]:
        run, rate = self.run, self.rate
        return {
            "scenario": run.scenario,
            "engine": run.engine,
            "seed": self.scenario.seed,
            "stopped": run.stopped,
            "steps": run.steps,
            "refused_samples": run.refused,
            "saturated_samples": run.saturated,
            "missed_samples": run.missed,
            "not_modelled": list(run.left_out),
            "metrics": dict(self.metrics),
            "limits": dict(self.scenario.limits),
            "switches": [{"time": time, "to": name} for time, name in run.switches],
            "contacts": [
                {"time": time, "environment": name, "made": is_made}
                for time, name, is_made in run.contacts
            ],
            "certified_bounds": [
                {
                    "output": b.output,
                    "unit": b.unit,
                    "level": b.level,
                    "holds_for_this_run": not b.uncovered,
                    "uncovered": list(b.uncovered),
                }
                for b in self.bounds
            ],
            "certified_rate": None
            if rate is None
            else {
                "rate": rate.rate,
                "unit": rate.unit,
                "attained": rate.attained,
                "from": rate.start,
                "holds_for_this_run": not rate.uncovered,
                "uncovered": list(rate.uncovered),
            },
        }

    def _drawings(self) -> Figures:
        return [("run", self._draw)]

    def _draw(self) -> Figure:
        from nrs_design.reporting.figures.simulated import draw_simulated
        from nrs_design.simulation.run import common_lever_arm

        spec = self.designed.spec
        environments = [surface.environment for surface in self.scenario.surfaces]
        level = next(((b.level, not b.uncovered) for b in self.bounds if b.output == "force"), None)
        return draw_simulated(
            self.response,
            spec.limits.torque.si,
            spec.limits.velocity.si,
            common_lever_arm(spec, environments),
            level,
        )

    def _headline(self) -> str:
        stopped = f", STOPPED: {self.run.stopped}" if self.run.stopped else ""
        return f"{self.name}: {len(self.time)} instants, {self.time[-1]:.6g} s{stopped}"

    def _rows(self) -> Iterator[Sequence[str]]:
        from nrs_design.reporting.simulation import metric_rows

        yield "", "value", "unit", "limit"
        yield from metric_rows(self.metrics, self.scenario.limits)


@dataclass(frozen=True, repr=False)
class Simulation(AbstractResult):
    """Runs of one spec, in the order of its scenarios."""

    designed: Designed  # The spec and its gains
    runs: tuple[ScenarioRun, ...]

    @classmethod
    def of(
        cls, designed: Designed, simulated: Sequence[Simulated], proof: Certificate | None
    ) -> Simulation:
        """Return the runs, beside what is certified.

        Parameters
        ----------
        designed, simulated, proof
            The spec and its gains, its runs, and a certificate that was checked against the spec.
        """
        from nrs_design.pipeline.scenarios import hold_bounds, hold_rate

        if proof is None:
            return cls(designed, tuple(ScenarioRun(designed, run) for run in simulated))
        runs = []
        for run in simulated:
            bounds = hold_bounds(designed, proof, run)
            runs.append(ScenarioRun(designed, run, bounds, hold_rate(designed, proof, run)))
        return cls(designed, tuple(runs))

    def __iter__(self) -> Iterator[ScenarioRun]:
        """Run after run."""
        return iter(self.runs)

    def __len__(self) -> int:
        """How many runs there are."""
        return len(self.runs)

    def __getitem__(self, key: int | str) -> ScenarioRun:
        """Return a run by its place or by the name of its scenario."""
        if not isinstance(key, str):
            return self.runs[key]
        runs_by_name = {one.name: one for one in self.runs}
        if key not in runs_by_name:
            remedy = f"scenarios here: {', '.join(runs_by_name)}"
            raise DesignError(f"there is no run of {key!r}", remedy=remedy)
        return runs_by_name[key]

    def _axis(self) -> object:
        return self.designed.spec.axis

    def _facts(self) -> dict[str, Any]:
        runs = [one.to_dict() for one in self.runs]
        return self.designed.loaded.facts | {"runs": runs, "files": []}

    def _drawings(self) -> Figures:
        return [(one.name, one.plot) for one in self.runs]

    def _headline(self) -> str:
        count = len(self.runs)
        return f"{self.designed.spec.name}: {count} run{'s' * (count != 1)}, which prove nothing"

    def _rows(self) -> Iterator[Sequence[str]]:
        from nrs_design.reporting.simulation import four_digits_up

        yield "run", *(f"{name.replace('_', ' ')}" for name, _ in _TABLE_METRICS), "stopped"
        for one in self.runs:
            values = (
                f"{four_digits_up(float(one.metrics[name]))} {unit(turning)}".rstrip()
                for name, turning in _TABLE_METRICS
            )
            yield one.name, *values, one.run.stopped or ""
