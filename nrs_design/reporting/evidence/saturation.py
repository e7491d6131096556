"""Decay although signals saturate: from where, and a run that begins at the stated size."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import numpy as np

from nrs_design.proof.bounds import lower, nearly, rounded_down, rounded_up
from nrs_design.proof.mode import Time
from nrs_design.proof.saturation import Saturation
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.norms import matrix_blocks
from nrs_design.reporting.evidence.page import AbstractPage
from nrs_design.reporting.evidence.runs import simulated
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.titles import SATURATION
from nrs_design.simulation.greedy import all_modes, greedy_run, relative_norms
from nrs_design.simulation.norms import clipped, quadratic_norm
from nrs_design.simulation.saturation import share_cut_off

_MEANING = (
    "Wherever V = w' Q w <= 1, each signal is a mixture of its argument and of h w, which keeps "
    "its limit there; so the loop moves as a mixture of linear ones, in all of which V decreases. "
    "A higher limit leaves it such a mixture."
)
_RUN = (
    "Simulated run from rest with the stated {start}, at the softest: at every step the adversary "
    "takes the possible mode after which V is largest. Signals are cut off at their limits: {cut}. "
    "It is a bad run, not the worst one; the root of V stays below the dashed bound. The run is no "
    "part of the proof."
)
_TEXT = (
    "The certificate holds the matrix Q, one row h for each signal, the rate and the size of the "
    "start. Here Q is scaled."
)
# Time constants of the fastest motion in a step, and decisions of a run.
_SHARE, _STEPS = 0.1, 1500


class SaturationPage(AbstractPage):
    """The limits, the start, Q, and a run."""

    name = "decay from an ellipsoid although signals saturate"

    def meaning(self) -> tuple[str, ...]:
        """State the region of decay, and how it was decided."""
        return (_MEANING, *words.unneeded_rules(self.system), words.decision(self.system))

    def limits(self) -> tuple[str, ...]:
        """State what remains open about other motions."""
        return (
            "Motions that begin outside of the ellipsoid: they may decay as well.",
            "Commands of a hand and disturbances while signals saturate.",
            f"That the {self._saturation.start.name} is within the limit of a spec: motions may "
            "begin beyond it.",
            "Lower limits, and other signals that saturate, such as the current of the motor.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show limits, start and matrix, and a run."""
        start, (level, rate) = self._saturation.start, self._shown
        name, unit = start.name.capitalize(), start.unit
        rows = [
            # Of a lower limit nothing is claimed.
            (f"Limit of the {s.name}", rounded_up(s.limit, s.unit))
            for s in self._saturation.signals
        ]
        rows.append((f"{name} at rest, proved", rounded_down(level, unit)))
        if start.wanted is not None:
            rows.append((f"{name} that is wanted", nearly(start.wanted, unit)))
        rows.append(("Rate of decay, proved", f"{lower(rate)} 1/s"))
        blocks = (
            Paragraph(_TEXT),
            Table("Decay although signals saturate", ("Quantity", "Value"), tuple(rows)),
            *matrix_blocks(self.offer.forms, self.system.states, "saturated-quadratic"),
            self._illustration(),
        )
        return (Section(SATURATION, blocks),)

    def run(self) -> Section:
        """Draw V along the run."""
        return simulated(self._illustration())

    @property
    def _saturation(self) -> Saturation:
        assert self.system.saturation is not None  # the evidence is about it
        return self.system.saturation

    @property
    def _shown(self) -> tuple[Fraction, Fraction]:
        """Size of the start, and rate of decay in 1/s."""
        level, rate = self.evidence.start_size, self.evidence.start_rate(self.system)
        assert level is not None  # it shows both
        assert rate is not None
        return level, rate

    def _illustration(self) -> Illustration:
        system, (level, rate), (form,) = self.system, self._shown, self.offer.forms
        Q = np.ldexp(np.array(form.Q, dtype=float), -self.offer.denominator_log2)
        norm, drawn = quadratic_norm(Q), system
        if system.contact is not None:
            norm, drawn = clipped(norm), all_modes(system)
        states = [np.array(x.floats())[:, 0] for x in self._saturation.start.states]
        initial = float(level) * max(states, key=lambda x: float(x @ Q @ x))
        response = greedy_run(system, norm, initial, self._step(), _STEPS)
        # A step of a sampled loop takes no less than the power of (1 - rate T) says.
        unit = 1.0 if system.time is Time.CONTINUOUS else float(system.sample_time or 1)
        bound = (f"exp(-{lower(rate)} t)", np.exp(-float(rate) * response.time * unit))
        cut = _cut_off(share_cut_off(system, response))
        label = "root of V over its first value [1]"
        return Illustration(
            "saturated-run",
            "Run with signals that saturate",
            _RUN.format(start=self._saturation.start.name, cut=cut),
            draw_run(response, relative_norms(response, norm), bound, drawn, label),
        )

    def _step(self) -> float:
        """Return how long a step of the run is: in s, or one."""
        if self.system.time is Time.DISCRETE:
            return 1.0
        modes = self.system.modes
        fastest = max(np.abs(np.linalg.eigvals(mode.A.floats())).max() for mode in modes)
        return _SHARE / float(fastest)


def _cut_off(shares: Mapping[str, float]) -> str:
    """Say for how much of a run each signal is cut off."""
    return ", ".join(
        f"the {name} for {number(100 * share, 2)} % of this run" if share else f"the {name} never"
        for name, share in shares.items()
    )
