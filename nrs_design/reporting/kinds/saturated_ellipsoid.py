"""Decay although signals saturate: from where, and a run that begins at the stated size."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from nrs_design.proof.bounds import lower, nearly, rounded_down, rounded_up
from nrs_design.proof.evidence import SaturatedEllipsoid
from nrs_design.proof.saturation import Saturation
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.formatting import number
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.matrix import matrix_table
from nrs_design.reporting.kinds.shared.run import simulated
from nrs_design.reporting.sections.titles import SATURATION
from nrs_design.simulation.contact import clipped, with_free_modes
from nrs_design.simulation.norms import quadratic_norm, scaled_matrices
from nrs_design.simulation.saturation import share_cut_off, worst_saturated
from nrs_design.simulation.switched import norms

_DECIDED = (
    "Q and the rows h are integers over powers of two, and exact arithmetic decides that V "
    "decreases in every mode with every choice of arguments and rows, and that the rows keep the "
    "limits wherever V <= 1. The solver only proposed Q and h"
)
_RUN = (
    "Simulated run from rest with the stated {start}, at the softest: at every step the adversary "
    "takes the possible mode after which V is largest. Signals are cut off at their limits: {cut}. "
    "It is a bad run, not the worst one; the root of V stays below the dashed bound. The run is no "
    "part of the proof."
)
# Time constants of the fastest motion in a step, and decisions of a run.
_SHARE, _STEPS = 0.1, 1500


class SaturatedEllipsoidPage(AbstractKindPage[SaturatedEllipsoid]):
    """The limits, the start, Q and H, and a run."""

    @property
    def name(self) -> str:
        """Its kind."""
        return "decay from an ellipsoid although signals saturate"

    @property
    def _saturation(self) -> Saturation:
        assert self.system.saturation is not None  # the evidence is about it
        return self.system.saturation

    def meaning(self) -> tuple[str, ...]:
        """Say what the set is, what follows, and how it was decided."""
        return (
            "Wherever V = w' Q w <= 1, each signal is a mixture of its argument and of h w, which "
            "keeps its limit there; so the loop moves as a mixture of linear ones, in all of which "
            "V decreases. A higher limit leaves it such a mixture.",
            *words.unneeded_rules(self.system),
            words.decision(_DECIDED),
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered."""
        return (words.all_corners(self.system, self.evidence),)

    def limits(self) -> tuple[str, ...]:
        """Say what is not shown of other motions."""
        return (
            "Motions that begin outside of the ellipsoid: they may decay as well.",
            "Commands of a hand and disturbances while signals saturate.",
            f"That the {self._saturation.start.name} is within the limit of a spec: motions may "
            "begin beyond it.",
            "Lower limits, and other signals that saturate, such as the current of the motor.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show limits, start and matrices, and a run."""
        evidence, start = self.evidence, self._saturation.start
        (Q,) = scaled_matrices(evidence.Q)
        H = np.array(evidence.H, dtype=float)
        H /= np.abs(H).max()
        rows = [
            *(
                # Of a lower limit nothing is claimed.
                (f"Limit of the {s.name}", rounded_up(s.limit, s.unit))
                for s in self._saturation.signals
            ),
            (
                f"{start.name.capitalize()} at rest, proved",
                rounded_down(evidence.level, start.unit),
            ),
            *(
                ((f"{start.name.capitalize()} that is wanted", nearly(start.wanted, start.unit)),)
                if start.wanted is not None
                else ()
            ),
            ("Rate of decay, proved", f"{lower(evidence.rate)} 1/s"),
        ]
        text = (
            "The certificate holds the matrix Q, one row h for each signal, the rate and the size "
            "of the start. Here Q and the rows are scaled."
        )
        blocks = (
            Paragraph(text),
            Table("Decay although signals saturate", ("Quantity", "Value"), tuple(rows)),
            *matrix_table("Q divided by its largest entry", Q, self.system.states),
            Table(
                "Rows h divided by the largest entry",
                ("Signal", *self.system.states),
                tuple(
                    (signal.name, *(number(entry, 4) for entry in row))
                    for signal, row in zip(self._saturation.signals, H.tolist(), strict=True)
                ),
            ),
            self._illustration(),
        )
        return (Section(SATURATION, blocks),)

    def run(self) -> Section:
        """Draw V along the run."""
        return simulated(self._illustration())

    def _illustration(self) -> Illustration:
        system, evidence = self.system, self.evidence
        Q = np.ldexp(np.array(evidence.Q, dtype=float), -evidence.denominator_log2)
        norm = quadratic_norm(Q)
        if system.contact is not None:
            norm = clipped(norm)
        states = [np.array(x.floats())[:, 0] for x in self._saturation.start.states]
        initial = float(evidence.level) * max(states, key=lambda x: float(x @ Q @ x))
        fastest = max(np.abs(np.linalg.eigvals(mode.A.floats())).max() for mode in system.modes)
        response = worst_saturated(system, norm, initial, _SHARE / float(fastest), _STEPS)
        values, shares = norms(response, norm), share_cut_off(system, response)
        bound = np.exp(-float(evidence.rate) * response.time)
        return Illustration(
            "saturated-run",
            "Run with signals that saturate",
            _RUN.format(start=self._saturation.start.name, cut=_words(shares)),
            draw_run(
                response,
                values,
                (f"exp(-{lower(evidence.rate)} t)", bound),
                system if system.contact is None else with_free_modes(system),
                "root of V over its first value [1]",
            ),
        )


def _words(shares: Mapping[str, float]) -> str:
    """Say for how much of a run each signal is cut off."""
    return ", ".join(
        f"the {name} for {number(100 * share, 2)} % of this run" if share else f"the {name} never"
        for name, share in shares.items()
    )
