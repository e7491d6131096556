"""A periodic signal along which a solution grows: simulated over many periods."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from nrs_design.proof.bounds import nearly
from nrs_design.proof.evidence import UnstablePeriod
from nrs_design.proof.mode import Time
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.formatting import number, plural
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.run import EUCLIDEAN, euclidean_norms, plane, witness
from nrs_design.simulation.norms import Array
from nrs_design.simulation.periodic import PeriodicRun, one_period, periodic_run

_LISTED = 24


class UnstablePeriodPage(AbstractKindPage[UnstablePeriod]):
    """The signal, one period of it, and how the state grows from period to period."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "a period that grows"

    def meaning(self) -> tuple[str, ...]:
        """Say why one signal is enough."""
        return (
            "The signal keeps every rule that the spec declares. Repeated forever, it multiplies "
            "some state by a factor above one in every period, so no stability of any kind can be "
            f"guaranteed under {words.allowed_signals(self.system)}. The matrix of one period is "
            "enclosed rigorously; a power of it has a trace that only an eigenvalue outside the "
            "unit circle can explain.",
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for other signals."""
        return (
            words.NO_FORECAST,
            "Nothing is said about other signals: a longer dwell time, fewer transitions or "
            "narrower ranges may make the family stable.",
            "Nothing is said about what saturation or friction would make of the growth.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Repeat the signal, from the direction that grows the most."""
        system, evidence = self.system, self.evidence
        index = {mode.name: k for k, mode in enumerate(system.modes)}
        steps = [(index[name], float(time)) for name, time in evidence.steps]
        run = periodic_run(system, steps, evidence.edges)
        first = one_period(run)
        periods = round(run.response.time[-1] / run.period)
        resets = " and the reset of each switch" if system.switching.resets else ""
        return witness(
            self._factor(run),
            self._steps(),
            Illustration(
                "run",
                f"The witness over {plural(periods, 'period')}",
                "Simulated from the direction that grows the most, with every mode for its time"
                f"{resets}. The dashed line is the growth per period, carried on.",
                draw_run(
                    run.response, euclidean_norms(run.response), _line(run), system, EUCLIDEAN
                ),
            ),
            Illustration(
                "one-period",
                "One period of the witness",
                "The first period of the same run: which mode is active when, and what it does to "
                "the norm.",
                draw_run(first, euclidean_norms(first), None, system, EUCLIDEAN),
            ),
            *plane(system, run.response),
        )

    @property
    def _unit(self) -> str:
        return "s" if self.system.time is Time.CONTINUOUS else "steps"

    def _factor(self, run: PeriodicRun) -> Paragraph:
        """Say how long a period is, and by which factor a state grows in it."""
        rate = number(math.log(run.radius) / run.period, 4)
        mean = f", a mean growth rate of {rate} 1/s" if self.system.time is Time.CONTINUOUS else ""
        return Paragraph(
            f"One period lasts {run.period:.6g} {self._unit} and has "
            f"{plural(len(self.evidence.steps), 'step')}. "
            f"Over one period some state grows by the factor {number(run.radius, 6)}{mean}. The "
            "certificate shows with rigorous enclosures that the factor is above one; these "
            "digits are floating point."
        )

    def _steps(self) -> Table:
        """List the modes of one period, their times, and the resets between them."""
        steps = self.evidence.steps
        names = [name for name, _ in steps]
        resets = self._resets(list(zip(names, (*names[1:], *names[:1]), strict=True)))
        columns = ("Step", "Mode", f"Time in it [{self._unit}]")
        rows: list[tuple[str, ...]] = [
            (str(k + 1), name, nearly(time)) for k, (name, time) in enumerate(steps[:_LISTED])
        ]
        title = "One period" + (f", its first {_LISTED} steps" if len(steps) > len(rows) else "")
        if not any(resets):
            return Table(title, columns, tuple(rows))
        then = tuple((*row, reset) for row, reset in zip(rows, resets, strict=False))
        return Table(title, (*columns, "Then"), then)

    def _resets(self, switches: Sequence[tuple[str, str]]) -> list[str]:
        """Say what each switch does to the state; nothing where it leaves it as it is."""
        maps, ways = self.system.switching.maps(), self.evidence.edges or (0,) * len(switches)
        texts = []
        for switch, way in zip(switches, ways, strict=True):
            count = len(maps.get(switch, ()))
            which = f"reset {way + 1} of {count}" if count > 1 else "reset"
            texts.append(f"{which} to {switch[1]}" if count else "")
        return texts


def _line(run: PeriodicRun) -> tuple[str, Array]:
    """Return the growth per period, carried on along a run, with its label."""
    label = f"factor {number(run.radius, 4)} per period"
    return label, np.exp(math.log(run.radius) * run.response.time / run.period)
