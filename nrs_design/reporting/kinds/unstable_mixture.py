"""An average of modes that is not stable: fast switching with its shares."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import UnstableMixture
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.complex_plane import draw_eigenvalues
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.formatting import number, roots
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.run import EUCLIDEAN, euclidean_norms, plane, witness
from nrs_design.simulation.periodic import (
    PeriodicRun,
    mixture_matrix,
    periodic_run,
    steps_of_mixture,
)
from nrs_design.simulation.switched import mode_eigenvalues


class UnstableMixturePage(AbstractKindPage[UnstableMixture]):
    """The average and its eigenvalues, and a run that comes near to it."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "an average that is not stable"

    def meaning(self) -> tuple[str, ...]:
        """Say what an average has to do with switching."""
        return (
            "If the modes were exponentially stable under arbitrary switching, uniformly over all "
            "signals, then so would be every average of them, which fast switching comes near to. "
            "This average is not stable, so no such guarantee is possible. The decision is exact; "
            "the eigenvalue is printed for the reader.",
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for slow switching."""
        return (
            words.NO_FORECAST,
            "Nothing is said about slower switching: every mode alone may be stable, and a dwell "
            "time may make the family stable.",
            words.ON_THE_BORDER,
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Switch fast, with the shares of the average."""
        system, weights = self.system, self.evidence.weights
        average = np.linalg.eigvals(mixture_matrix(system, weights)).astype(complex)
        run = periodic_run(system, steps_of_mixture(system, weights))
        rate = float(average.real.max())
        line = (f"the average alone, exp({rate:.4g} t)", np.exp(rate * run.response.time))
        shares = tuple((name, str(w), number(float(w), 4)) for name, w in weights)
        return witness(
            Paragraph(f"Eigenvalues of the average: {roots(average.tolist(), 6)} 1/s."),
            Table("The average", ("Mode", "Share (exact)", "Share [1]"), shares),
            self._spectra(average),
            Illustration(
                "run",
                "Fast switching with these shares",
                f"Every mode has its share of each period of {run.period:.4g} s. The faster the "
                "switching, the nearer it comes to the average, the dashed line. "
                + _outcome(run, rate),
                draw_run(run.response, euclidean_norms(run.response), line, system, EUCLIDEAN),
            ),
            *plane(system, run.response),
        )

    def _spectra(self, average: NDArray[np.complex128]) -> Illustration:
        names = [name for name, _ in self.evidence.weights]
        modes = tuple(mode for mode in self.system.modes if mode.name in names)
        mixed = replace(self.system, modes=modes)
        return Illustration(
            "mixture",
            "Eigenvalues of the average",
            "The modes that have a share in it, and their average, which is not stable.",
            draw_eigenvalues(
                [*(mode.name for mode in modes), "average"],
                [*mode_eigenvalues(mixed), average],
                mixed.time,
                None,
            ),
        )


def _outcome(run: PeriodicRun, rate: float) -> str:
    if run.radius > 1 and rate > 0:
        return f"At this period the state grows by the factor {number(run.radius, 5)} each time."
    return (
        "The average is on the border of stability, so the run need not grow; but no rate of decay "
        "holds for all signals."
    )
