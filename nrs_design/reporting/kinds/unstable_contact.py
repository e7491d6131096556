"""A motion that grows while contact is lost and made: simulated as it is in contact and free."""

from __future__ import annotations

import math

import numpy as np

from nrs_design.proof.bounds import lower
from nrs_design.proof.evidence import UnstableContact
from nrs_design.proof.evidence.unstable_contact import in_contact_and_free
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import ARBITRARY
from nrs_design.reporting.document import Illustration, Section, Table
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.formatting import number, plural
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.run import EUCLIDEAN, euclidean_norms, witness
from nrs_design.simulation.periodic import periodic_run

_LISTED = 24


class UnstableContactPage(AbstractKindPage[UnstableContact]):
    """The sequence of contact and flight, and how the motion grows along it."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "a motion that grows while contact is lost and made"

    def meaning(self) -> tuple[str, ...]:
        """Say why one motion is enough."""
        return (
            "The motion makes its sequence of contact and flight by itself: the environment acts "
            "only where the deflection is positive, and never pulls. Larger each time, it goes on "
            "for ever, so no stability of any kind can be guaranteed under "
            f"{words.allowed_signals(self.system)} with contact that may be lost. Its factor and "
            "its direction are enclosed rigorously, and every sign is decided for the enclosure.",
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for other motions."""
        return (
            words.NO_FORECAST,
            "Nothing is said about other motions, nor about other sequences of modes.",
            "Nothing is said about what saturation or friction would make of the growth.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Repeat the sequence, along the motion that grows."""
        evidence, modes = self.evidence, in_contact_and_free(self.system)
        system = self.system.with_modes(modes, self.system.states, ARBITRARY)
        index = {mode.name: k for k, mode in enumerate(modes)}
        low = float(evidence.factor[0])
        continuous = system.time is Time.CONTINUOUS
        time, factor = (1 / max(low, 1e-9), math.e) if continuous else (1.0, low)
        steps = [(index[name], count * time) for name, count in evidence.steps]
        run = periodic_run(system, steps, eigenvalue=factor)
        response = run.response
        growth = math.log(factor) * response.time / run.period
        line = (f"factor {number(factor, 4)} each time", np.exp(growth))
        rows = tuple((str(k), *map(str, step)) for k, step in enumerate(evidence.steps, 1))
        title = "The sequence" + (f", its first {_LISTED} parts" if len(rows) > _LISTED else "")
        unit = "1/s" if continuous else "each time"
        return witness(
            Table(title, ("Part", "Mode", "Steps"), rows[:_LISTED]),
            Illustration(
                "run",
                f"The witness over {plural(round(response.time[-1] / run.period), 'period')}",
                "Simulated from the enclosed direction, through contact and flight as the signs of "
                f"the motion say; it grows by {lower(evidence.factor[0])} {unit} at least.",
                draw_run(response, euclidean_norms(response), line, system, EUCLIDEAN),
            ),
        )
