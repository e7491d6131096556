"""The modes: where their eigenvalues lie."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.complex_plane import draw_eigenvalues
from nrs_design.reporting.formatting import list_first, number, roots
from nrs_design.reporting.sections.places import linked, locate_contact, locate_mode
from nrs_design.reporting.sections.titles import MODES
from nrs_design.simulation.norms import Array
from nrs_design.simulation.switched import mode_eigenvalues, mode_rates
from nrs_design.spec import LoadedSpec

Spectra = Sequence[NDArray[np.complex128]]

# A page holds no more; those nearest to the limit are shown.
_MAX_ROWS = 24
_MAX_MODES = 256
_MANY_STATES = 6


def modes_section(loaded: LoadedSpec, system: SwitchedSystem, rate: Fraction | None) -> Section:
    """List the modes with their eigenvalues."""
    values = mode_eigenvalues(system)
    slowest = _slowest_first(values, system.time)
    plotted = np.sort(slowest[:_MAX_MODES])
    names, spectra = [system.modes[i].name for i in plotted], [values[i] for i in plotted]
    figure = draw_eigenvalues(names, spectra, system.time, rate)
    caption = _caption(system, len(plotted), rate)
    return Section(
        MODES,
        (
            Paragraph(f"States, in this order: {list_first(system.states, 16)}."),
            _table(loaded, system, values, slowest[:_MAX_ROWS]),
            Illustration("eigenvalues", "Eigenvalues of the modes", caption, figure),
        ),
    )


def hardest_modes(system: SwitchedSystem, Q: Array | None, limit: int) -> SwitchedSystem:
    """Keep the modes that decay the slowest, at most so many, in the order of the system.

    They decay in the norm of Q; without one, eigenvalues say which are slow.
    """
    if len(system.modes) <= limit:
        return system
    if Q is None:
        slowest = _slowest_first(mode_eigenvalues(system), system.time)
    else:
        rates = mode_rates(system, Q)
        slowest = np.argsort(rates if system.time is Time.CONTINUOUS else -rates, kind="stable")
    indices = np.sort(slowest[:limit])
    return replace(system, modes=tuple(system.modes[i] for i in indices))


def _slowest_first(values: Spectra, time: Time) -> NDArray[np.int64]:
    continuous = time is Time.CONTINUOUS
    largest = [(row.real if continuous else np.abs(row)).max() for row in values]
    return np.argsort(-np.array(largest), kind="stable")


def _table(
    loaded: LoadedSpec, system: SwitchedSystem, values: Spectra, indices: NDArray[np.int64]
) -> Table:
    continuous = system.time is Time.CONTINUOUS
    rows = []
    for i in np.sort(indices):
        row = sorted(values[i].tolist(), key=lambda z: -(z.real if continuous else abs(z)))
        worst = row[0].real if continuous else abs(row[0])
        root_texts = roots(row[:_MANY_STATES], 5) + (" …" if len(row) > _MANY_STATES else "")
        name = system.modes[i].name
        home = locate_mode(loaded, name)
        contact = locate_contact(loaded, name) or home
        numbers = (linked(loaded, text, *contact) for text in (root_texts, number(worst, 5)))
        rows.append((linked(loaded, name, *home), *numbers))
    unit = " [1/s]" if continuous else ""
    size = "Largest real part [1/s]" if continuous else "Largest modulus"
    scope = "" if len(rows) == len(system.modes) else f", the {len(rows)} slowest of them"
    title = f"The {len(system.modes)} modes{scope}" if len(system.modes) > 1 else "The one mode"
    return Table(title, ("Mode", f"Eigenvalues{unit}", size), tuple(rows))


def _caption(system: SwitchedSystem, plotted_count: int, rate: Fraction | None) -> str:
    omission = (
        ""
        if plotted_count == len(system.modes)
        else f" The {plotted_count} slowest modes are drawn."
    )
    lasting = len(system.lasting_modes())
    subject = "all" if lasting == len(system.modes) else "those of modes that may last"
    if system.time is Time.CONTINUOUS:
        text = "A mode is stable if all its eigenvalues lie left of the imaginary axis"
        border = f"; {subject} lie left of the dashed line, the proved rate."
    else:
        text = "A mode is stable if all its eigenvalues lie inside the unit circle"
        border = f"; {subject} lie inside the dashed circle, the proved contraction."
    text += border if rate and lasting else "."
    if lasting < len(system.modes):
        text += " A mode that must be left need not be stable."
    return f"{text} Stable modes alone do not make switching stable.{omission}"
