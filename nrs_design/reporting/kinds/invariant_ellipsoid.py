"""How far a disturbance can push an output: the proved level beside an adversary's run."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from nrs_design.proof.bounds import nearly, rounded_down, rounded_up
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.evidence import InvariantEllipsoid
from nrs_design.proof.mode import Time
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.bound import draw_bound
from nrs_design.reporting.formatting import number
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.run import simulated
from nrs_design.simulation.worst_case import WorstRun, worst_against
from nrs_design.simulation.worst_outputs import output_values

_DECIDED = (
    "Q holds integers over a power of two, and exact arithmetic decides that no motion leaves the "
    "set V <= 1 while the disturbance keeps its bound, and how far that set reaches. The solver "
    "only proposed Q"
)
_RUN = (
    "Simulated run from rest: an adversary chooses the modes and the sign of the largest "
    "disturbance at every step, and improves his choice a few times. It is a bad run, not the "
    "worst one; the shading covers the corners of the output. No run crosses the dashed lines."
)


class InvariantEllipsoidPage(AbstractKindPage[InvariantEllipsoid]):
    """The level, and a run that tries to reach it."""

    @property
    def name(self) -> str:
        """Its kind."""
        return "bound on an output under a disturbance"

    @property
    def _channels(self) -> tuple[Channel, ...]:
        return self.evidence.acting(self.system)

    @property
    def _disturbance(self) -> str:
        every = len(self._channels) == len(self.system.channels) > 1
        return "all disturbances at once" if every else ", ".join(self.evidence.channels)

    @property
    def _output(self) -> Output:
        return next(o for o in self.system.outputs if o.name == self.evidence.output)

    def meaning(self) -> tuple[str, ...]:
        """Say what is not left, and how it was decided."""
        return (
            "From rest, the state does not leave the set V = w' Q w <= 1 while the disturbance "
            "keeps its bound, however it changes; from any other state, V comes down to 1.",
            *words.unneeded_rules(self.system),
            words.decision(_DECIDED),
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered."""
        return (words.all_corners(self.system, self.evidence),)

    def limits(self) -> tuple[str, ...]:
        """Say what the bound is not."""
        between = ("What happens between two steps.",) if self._is_discrete else ()
        return (
            "Other disturbances beside those named, and larger ones.",
            "That the bound is reached: the largest possible value may be smaller.",
            *between,
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the level beside the run that an adversary finds."""
        evidence, output = self.evidence, self._output
        run = self._found()
        values = output_values(self.system, output, run.states)
        found = nearly(Fraction(float(np.abs(values).max())), output.unit)
        rows = [
            *(
                ("Disturbance", f"|{item.name}| <= {rounded_down(item.bound, item.unit)}")
                for item in self._channels
            ),
            (f"|{output.name}|, proved never to exceed", rounded_up(evidence.level, output.unit)),
            (f"|{output.name}|, found by simulation", found),
        ]
        if output.limit is not None:
            rows.append(("Limit of the spec", nearly(output.limit, output.unit)))
        share = number(float(sum(evidence.shares)), 4)
        unit = "per step" if self._is_discrete else "1/s"
        text = (
            f"The certificate holds Q and the share a = {share} {unit}: V grows by at most a times "
            "1 - V. What was found by simulation is no part of the proof."
        )
        return (
            Section(
                f"Bound on {output.name} under {self._disturbance}",
                (
                    Paragraph(text),
                    Table("Bound and simulation", ("Quantity", "Value"), tuple(rows)),
                    self._illustration(run),
                ),
            ),
        )

    def run(self) -> Section:
        """Draw the adversary's run between the bounds."""
        return simulated(self._illustration(self._found()))

    def _found(self) -> WorstRun:
        return worst_against(self.system, self.evidence.bound(self.system))

    @property
    def _is_discrete(self) -> bool:
        return self.system.time is Time.DISCRETE

    def _illustration(self, run: WorstRun) -> Illustration:
        system, output = self.system, self._output
        unit = "steps" if self._is_discrete and system.sample_time is None else "s"
        return Illustration(
            f"bound-{self._disturbance}-{output.name}".replace(" ", "-"),
            f"{output.name.capitalize()} under {self._disturbance}",
            _RUN,
            draw_bound(
                run.time,
                output_values(system, output, run.states),
                float(self.evidence.level),
                None if output.limit is None else float(output.limit),
                f"{output.name.capitalize()} [{output.unit}]",
                unit,
            ),
        )
