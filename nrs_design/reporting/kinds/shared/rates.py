"""How every mode fares in a Lyapunov function: a table and a figure."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Illustration, Table
from nrs_design.reporting.figures.lyapunov import draw_mode_rates
from nrs_design.reporting.formatting import number
from nrs_design.simulation.norms import Array

# A page holds no more; those with the least slack are shown.
LISTED = 24


def rate_blocks(
    system: SwitchedSystem, rates: Array, claimed: Fraction, norm: str, explained: str
) -> tuple[Block, ...]:
    """Return the modes with the least slack as a table and as a figure.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    rates : ndarray, shape (m,)
        Of every mode alone, in 1/s, or per step.
    claimed : Fraction
        Rate of the certificate.
    norm : str
        Which norm it is, such as ``the norm of Q``.
    explained : str
        What the rate of a mode is, as a sentence.
    """
    continuous = system.time is Time.CONTINUOUS
    order = np.argsort(rates if continuous else -rates, kind="stable")[:LISTED]
    names = [system.modes[i].name for i in order]
    border = "right of the claimed rate" if continuous else "left of the claimed contraction"
    some = "" if len(names) == len(rates) else f" The {len(names)} modes with the least slack."
    quantity = "Decay rate" if continuous else "Contraction"
    figure = draw_mode_rates(names, rates[order], claimed, system.time, norm)
    return (
        _table(system, rates[order], names, claimed, f"{quantity} in {norm}"),
        Illustration(
            "mode-rates",
            "Decrease in every mode",
            f"{explained} All lie {border}.{some}",
            figure,
        ),
    )


def _table(
    system: SwitchedSystem, rates: Array, names: list[str], claimed: Fraction, heading: str
) -> Table:
    continuous = system.time is Time.CONTINUOUS
    rows = []
    for name, rate in zip(names, rates.tolist(), strict=True):
        slack = rate - float(claimed) if continuous else float(claimed) - rate
        rows.append((name, number(rate, 6), number(slack, 3)))
    unit = " [1/s]" if continuous else " [1]"
    some = "" if len(rows) == len(system.modes) else f" ({len(rows)} with the least slack)"
    title = f"Rate of every mode alone{some}; claimed for all: {rate_words(claimed, system.time)}"
    return Table(title, ("Mode", f"{heading}{unit}", f"Slack{unit}"), tuple(rows))
