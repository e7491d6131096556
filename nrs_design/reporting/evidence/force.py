"""Contact that settles under a constant force: the function, and a run from the air."""

from __future__ import annotations

import numpy as np

from nrs_design.reporting.document import Illustration, Paragraph, Section
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.norms import matrix_blocks
from nrs_design.reporting.evidence.page import AbstractPage
from nrs_design.reporting.evidence.runs import (
    Greedy,
    simulated,
    trials_per_step,
)
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.constant_force import pushed_in, pushed_norm
from nrs_design.simulation.norms import scaled_matrices
from nrs_design.simulation.rates import mode_rates

_MEANING = (
    "In units of d, and counted from there, the deflection is e. The function is "
    "V = w' Q w + 2 s max(-1 - e, 0), where w holds the other states, and e or, in the air, -1: it "
    "decreases in contact and in free motion, and is zero only at rest."
)
_LIMITS = (
    "A stiffness that changes while the force pushes in, another environment, and a force Fd that "
    "changes: they move the deflection at which F = Fd.",
    "A velocity command beside the force: where the loop then rests depends on the gains.",
    "How long it takes until the force settles, and how large it becomes until then.",
)
_RUN = (
    "Simulated run from rest in the air, as far from the surface as the axis will press in: at "
    "every step the adversary takes the possible mode after which V is largest, at any end of the "
    "stiffness, as if the point of rest stayed where it is. That is more than the claim is about. "
    "It is a bad run, not the worst one; V never rises."
)

_LABEL = "root of V over its first value [1]"


class ForcePage(AbstractPage):
    """Q, and a run that is pushed into contact."""

    name = "contact that settles under a constant force"

    def meaning(self) -> tuple[str, ...]:
        """Say what V is, what follows, and how it was decided."""
        return (_MEANING, *words.unneeded_rules(self.system), words.decision(self.system))

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered, as far as they may move."""
        how = "the stiffness as long as it does not change, all else however fast it changes"
        return (words.all_corners(self.system, self.evidence, how),)

    def limits(self) -> tuple[str, ...]:
        """Say what would move the point of rest, and that time and force are not bounded."""
        return _LIMITS

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the matrix of the certificate, and a run."""
        text = (
            "The certificate holds the matrix Q, with the deflection as its last state, and the "
            f"number s, both with denominator 2^{self.offer.denominator_log2}; here Q is scaled. "
            "The run is no part of the proof."
        )
        matrices = matrix_blocks(self.offer.forms, self.system.states, "constant-force-quadratic")
        blocks = (Paragraph(text), *matrices, self._illustration())
        return (Section("Contact under a constant force", blocks),)

    def run(self) -> Section:
        """Draw the function along a run from the air, and when there is contact."""
        return simulated(self._illustration())

    def _illustration(self) -> Illustration:
        (numerators,), (slope,) = (form.Q for form in self.offer.forms), self.offer.numbers
        (Q,) = scaled_matrices(numerators)
        largest = max(abs(entry) for row in numerators for entry in row)
        norm = pushed_norm(Q, float(slope / largest))
        hardest = hardest_modes(self.system, Q, trials_per_step(self.system))
        driven = pushed_in(hardest)
        initial = np.zeros(driven.order)
        initial[-2:] = 1.0, -1.0
        slowest = float(mode_rates(hardest, Q).min())
        greedy = Greedy(self.system, driven, norm, initial, slowest)
        title, name = "Run under a constant force", "constant-force-run"
        return greedy.draw(title, _RUN, _LABEL, name=name)[1]
