"""From a design to many runs of its scenarios, in as many processes as one likes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from nrs_design.errors import DesignError
from nrs_design.pipeline.design import Designed, placed
from nrs_design.pipeline.scenarios import Runs, scenarios_of, simulate_group

if TYPE_CHECKING:
    from nrs_design.simulation.monte_carlo import Outcome, Share
    from nrs_design.simulation.scenario import Scenario

# Runs that a process is given at once.
_CHUNK = 4


@dataclass(frozen=True, slots=True)
class MonteCarlo:
    """Many runs that are to be simulated."""

    designed: Designed  # The spec, its plant and its gains
    wanted: Runs  # Which scenarios, and how
    runs: int  # How many
    seed: int  # Of what is drawn

    @property
    def scenarios(self) -> list[Scenario]:
        """The scenarios of one axis, in SI.

        Raises
        ------
        DesignError
            If one of three axes is wanted by its name.
        """
        with placed(self.designed.loaded):
            groups = scenarios_of(self.designed, self.wanted)
            for name, group in groups:
                if len(group) > 1 and name in self.wanted.names:
                    raise DesignError(
                        f"{name} moves three axes, and what is drawn is for one",
                        remedy="name scenarios of one axis",
                        at=("scenarios", name, "axes"),
                    )
        return [group[0] for _, group in groups if len(group) == 1]

    @property
    def limits(self) -> Mapping[str, Mapping[str, float]]:
        """The limits of every scenario: its own, and that of the torque; SI.

        The spec's limit of the velocity is that of the command, which no scenario exceeds.
        """
        common = {"torque": self.designed.spec.limits.torque.si}
        return {one.name: common | dict(one.limits) for one in self.scenarios}


@dataclass(frozen=True, slots=True)
class Drawing:
    """What all runs came to."""

    outcomes: tuple[Outcome, ...]  # Of one run after the other, in SI
    shares: Mapping[str, Share]  # Of runs above the limit, for each quantity that has one
    limits: Mapping[str, Mapping[str, float]]  # Of the quantities in every scenario, in SI


def draw_runs(asked: MonteCarlo, jobs: int = 1) -> Drawing:
    """Simulate all runs.

    Parameters
    ----------
    asked : MonteCarlo
        What is simulated.
    jobs : int
        Processes.
    """
    from nrs_design.simulation.monte_carlo import shares

    outcomes = tuple(run_monte_carlo(asked, 0, jobs))
    return Drawing(outcomes, shares(outcomes, asked.limits), asked.limits)


def run_monte_carlo(asked: MonteCarlo, first: int = 0, jobs: int = 1) -> Iterator[Outcome]:
    """Simulate the runs from one on, in their order, whatever processes there are.

    Parameters
    ----------
    asked : MonteCarlo
        What is simulated.
    first : int
        Index of the first run: those before are known.
    jobs : int
        Processes; with one, this one alone.

    Yields
    ------
    Outcome
        Of one run after the other.

    Raises
    ------
    DesignError, DataError
        If there is no such scenario, or it cannot be simulated.
    """
    indices = range(first, asked.runs)
    simulator = _Simulator(asked, asked.scenarios)
    if jobs == 1 or len(indices) < 2:
        yield from map(simulator.run, indices)
        return
    from multiprocessing import get_context

    with get_context().Pool(jobs, _begin, (simulator,)) as pool:
        yield from pool.imap(_run, indices, _CHUNK)


@dataclass(frozen=True, slots=True)
class _Simulator:
    asked: MonteCarlo
    scenarios: list[Scenario]

    def run(self, index: int) -> Outcome:
        from nrs_design.simulation.coverage import uncovered_by_chance
        from nrs_design.simulation.monte_carlo import Outcome, draw

        designed = self.asked.designed
        drawn = draw(
            designed.spec,
            designed.plant,
            designed.design,
            self.scenarios,
            self.asked.seed,
            index,
        )
        with placed(designed.loaded):
            mine = replace(designed, plant=drawn.plant, design=drawn.design)
            scenario = drawn.scenario
            (one,) = simulate_group(mine, scenario.name, (scenario,), self.asked.wanted)
        uncovered = [*uncovered_by_chance(designed.spec, one.run)]
        return Outcome.of(index, drawn, one.metrics, one.run.stopped, uncovered)


_simulators: list[_Simulator] = []


def _begin(simulator: _Simulator) -> None:
    """Prepare a process; who asked for the runs decides what an interrupt does."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _simulators[:] = [simulator]


def _run(index: int) -> Outcome:
    return _simulators[0].run(index)
