"""A run through contact and free motion that looks bad, below a proved bound."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Section
from nrs_design.reporting.figures.contact import draw_deflection
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.kinds.shared.run import (
    AGAINST,
    bound_line,
    freely,
    horizon,
    simulated,
    some_modes,
    until_small,
)
from nrs_design.simulation.contact import with_free_modes, worst_contact
from nrs_design.simulation.switched import norms

if TYPE_CHECKING:
    from nrs_design.simulation.norms import Array, Norm

_RUN = (
    "Simulated run from the slowest direction in contact: at every step the adversary takes the "
    "possible mode after which the norm is largest. It is a bad run, not the worst one. The dashed "
    "line is the bound of the certificate, which holds for every switching signal and any loss of "
    "contact."
)


def bouncing_run(
    system: SwitchedSystem,
    hardest: SwitchedSystem,
    norm: Norm,
    initial: Array,
    rate: float,
    label: str,
    note: str = "",
) -> Section:
    """Let the greedy adversary run, and draw it below its bound, and when contact is lost.

    Parameters
    ----------
    system, hardest : SwitchedSystem
        All modes, and those that take part.
    norm : callable
        Of states in contact and free, as `nrs_design.simulation.contact.clipped` gives it.
    initial : ndarray, shape (n,)
        Where the run begins, or opposite to it: in contact.
    rate : float
        The proved one.
    label : str
        Which norm it is, such as ``in the norm of Q``.
    note : str
        A sentence of the caption about the run, with a blank before it.
    """
    initial = initial if initial[-1] > 0 else -initial
    step, steps = horizon(with_free_modes(hardest), rate)
    response = worst_contact(hardest, norm, initial, step, steps)
    response = until_small(response, norms(response, norm))
    deflection = response.state[:, -1]
    unit = "steps" if system.time is Time.DISCRETE else "s"
    return simulated(
        Illustration(
            "run",
            AGAINST,
            f"{_RUN}{note}{freely(system)}{some_modes(system, hardest)}",
            draw_run(
                response,
                norms(response, norm),
                bound_line(response, rate, system.time, "proved bound, "),
                with_free_modes(hardest),
                f"|w(t)| / |w(0)| {label} [1]",
            ),
        ),
        Illustration(
            "deflection",
            "Contact during this run",
            "Deflection of the same run; shaded where the environment is not touched.",
            draw_deflection(
                response.time, deflection / np.abs(deflection).max(), system.states[-1], unit
            ),
        ),
    )
