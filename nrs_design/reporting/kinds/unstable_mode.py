"""A mode that is not stable: simulated alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from nrs_design.proof.evidence import UnstableMode
from nrs_design.proof.evidence.unstable_mode import free_motions, worst_eigenvalue
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Section
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.run import EUCLIDEAN, euclidean_norms, plane, witness
from nrs_design.simulation.norms import Array
from nrs_design.simulation.switched import SwitchedRun, alone, unstable_run


class UnstableModePage(AbstractKindPage[UnstableMode]):
    """What one mode does by itself."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "a mode that is not stable"

    def meaning(self) -> tuple[str, ...]:
        """Say why one mode is enough."""
        region = "left half plane" if self.system.time is Time.CONTINUOUS else "unit disk"
        return (
            f"The mode has an eigenvalue outside the open {region}. Staying in this mode forever "
            "is one of the switching signals that the spec allows, so exponential stability under "
            f"{words.allowed_signals(self.system)} is impossible. The decision is exact; the "
            "eigenvalue is printed for the reader.",
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for the other modes."""
        return (
            words.NO_FORECAST,
            "Nothing is said about the other modes, nor about switching that avoids this mode or "
            "leaves it soon enough.",
            words.ON_THE_BORDER,
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Stay in the mode, from the eigenvector of its worst eigenvalue."""
        name = self.evidence.mode
        modes = (*self.system.modes, *free_motions(self.system))
        index = next(i for i, mode in enumerate(modes) if mode.name == name)
        single = alone(replace(self.system, modes=modes), index)
        response = unstable_run(single, 0)
        eigenvalue = worst_eigenvalue(single.modes[0].A, single.time)
        growth, norms = _growth(single, response), euclidean_norms(response)
        run = Illustration(
            "run",
            f"Staying in mode {name}",
            f"Simulated from the eigenvector of the eigenvalue (about {eigenvalue}): the state "
            "does not decay. No other mode is used, which the switching allows.",
            draw_run(response, norms, growth, single, EUCLIDEAN),
        )
        return witness(run, *plane(single, response))


def _growth(system: SwitchedSystem, response: SwitchedRun) -> tuple[str, Array]:
    """Return how the worst eigenvalue of the one mode grows by itself, with its label."""
    values = np.linalg.eigvals(np.array(system.modes[0].A.floats()))
    if system.time is Time.CONTINUOUS:
        rate = float(values.real.max())
        return f"the eigenvalue alone, exp({rate:.4g} t)", np.exp(rate * response.time)
    factor = float(np.abs(values).max())
    return f"the eigenvalue alone, {factor:.4g}^t", factor**response.time
