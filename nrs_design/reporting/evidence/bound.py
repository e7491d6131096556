"""How far a disturbance can push an output: the proved level beside an adversary's run."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from nrs_design.proof.bounds import nearly, rounded_down, rounded_up
from nrs_design.proof.evidence.abstract import Bound
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.page import AbstractPage
from nrs_design.reporting.evidence.runs import simulated
from nrs_design.reporting.figures.bounded_run import BoundedSignal, draw_bounded_run
from nrs_design.reporting.formatting import number
from nrs_design.simulation.greedy import all_modes
from nrs_design.simulation.switched import SwitchedRun
from nrs_design.simulation.worst_case import WorstRun, worst_against
from nrs_design.simulation.worst_outputs import output_values

_MEANING = (
    "From rest, the state does not leave the set V = w' Q w <= 1 while the disturbance keeps its "
    "bound, however it changes; from any other state, V comes down to 1."
)
_RUN = (
    "Simulated run from rest: an adversary chooses the modes and the sign of the largest "
    "disturbance at every step, and improves his choice a few times. It is a bad run, not the "
    "worst one; the shading covers the corners of the output. No run crosses the dashed lines."
)


class BoundPage(AbstractPage):
    """The level, and a run that tries to reach it."""

    name = "bound on an output under a disturbance"

    def meaning(self) -> tuple[str, ...]:
        """State the invariant set, and how it was decided."""
        system = self.system
        return (_MEANING, *words.unneeded_rules(system), words.decision(system))

    def limits(self) -> tuple[str, ...]:
        """State what the bound leaves open."""
        between = ("What happens between two steps.",) if self.is_discrete else ()
        return (
            "Other disturbances beside those named, and larger ones.",
            "That the bound is reached: the largest possible value may be smaller.",
            *between,
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the level beside the run that an adversary finds."""
        bound, run = self._bound, worst_against(self.system, self._bound)
        output, unit = bound.output, bound.output.unit
        values = output_values(self.system, output, run.states)
        found = nearly(Fraction(float(np.abs(values).max())), unit)
        rows = [
            *(
                ("Disturbance", f"|{item.name}| <= {rounded_down(item.bound, item.unit)}")
                for item in bound.channels
            ),
            (f"|{output.name}|, proved never to exceed", rounded_up(bound.level, unit)),
            (f"|{output.name}|, found by simulation", found),
        ]
        if output.limit is not None:
            rows.append(("Limit of the spec", nearly(output.limit, unit)))
        share = f"{number(float(bound.share), 4)} {'per step' if self.is_discrete else '1/s'}"
        text = (
            f"The certificate holds Q and the share a = {share}: V grows by at most a times 1 - V. "
            "What was found by simulation is no part of the proof."
        )
        table = Table("Bound and simulation", ("Quantity", "Value"), tuple(rows))
        title = f"Bound on {output.name} under {self._disturbance}"
        return (Section(title, (Paragraph(text), table, self._illustration(run))),)

    def run(self) -> Section:
        """Draw the adversary's run between the bounds."""
        return simulated(self._illustration(worst_against(self.system, self._bound)))

    @property
    def _bound(self) -> Bound:
        bound = self.evidence.bound(self.system)
        assert bound is not None  # it shows one
        return bound

    @property
    def _disturbance(self) -> str:
        acting = self._bound.channels
        every = len(acting) == len(self.system.channels) > 1
        return "all disturbances at once" if every else ", ".join(item.name for item in acting)

    def _illustration(self, run: WorstRun) -> Illustration:
        system, output, level = self.system, self._bound.output, float(self._bound.level)
        signal = BoundedSignal(
            f"{output.name.capitalize()} [{output.unit}]",
            output_values(system, output, run.states),
            None if output.limit is None else float(output.limit),
            np.full(len(run.time), level),
        )
        names = [mode.name for mode in all_modes(system).modes]
        unit = "steps" if self.is_discrete and system.sample_time is None else "s"
        response = SwitchedRun(run.time, run.states, run.mode)
        return Illustration(
            f"bound-{self._disturbance}-{output.name}".replace(" ", "-"),
            f"{output.name.capitalize()} under {self._disturbance}",
            _RUN,
            draw_bounded_run(response, [signal], names, unit),
        )
