"""The modes: where their eigenvalues lie, and how each fares in the common quadratic function."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.certificates.evidence import CommonQuadratic
from nrs_design.certificates.evidence.fields import rate_text
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.complex_plane import draw_eigenvalues
from nrs_design.reporting.figures.lyapunov import draw_mode_rates, draw_quadratic
from nrs_design.reporting.formatting import number, roots, shortened
from nrs_design.simulation.switched import eigenvalues, mode_rates
from nrs_design.switched.system import SwitchedSystem, Time

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nrs_design.simulation.switched import Array

# A page holds no more; those nearest to the limit are shown.
_LISTED = 24
_DRAWN = 256
_MANY_STATES = 6
_WRITTEN = 8


def modes_section(system: SwitchedSystem, rate: float | None) -> Section:
    """List the modes with their eigenvalues.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    rate : float or None
        The proved rate; None where nothing is proved.
    """
    values = eigenvalues(system)
    slowest = _slowest_first(values, system.time)
    drawn = np.sort(slowest[:_DRAWN])
    return Section(
        "Modes",
        (
            Paragraph(f"States, in this order: {shortened(system.states, 16)}."),
            _table(system, values, slowest[:_LISTED]),
            Illustration(
                "eigenvalues",
                "Eigenvalues of the modes",
                _caption(system, len(drawn), rate),
                draw_eigenvalues(
                    [system.modes[i].name for i in drawn], values[drawn], system.time, rate
                ),
            ),
        ),
    )


def lyapunov_section(system: SwitchedSystem, evidence: CommonQuadratic) -> Section:
    """Show the matrix of the certificate and how every mode decreases it."""
    Q = scaled_matrix(evidence)
    rates = mode_rates(system, Q)
    continuous = system.time is Time.CONTINUOUS
    order = np.argsort(rates if continuous else -rates, kind="stable")[:_LISTED]
    names = [system.modes[i].name for i in order]
    text = (
        "The certificate holds the matrix Q of V(x) = x' Q x. "
        f"It is written with denominator 2^{evidence.denominator_log2}; here it is scaled. "
        + _cost_of_other_norm(Q)
    )
    return Section(
        "Lyapunov evidence",
        (
            Paragraph(text),
            *_matrix_table(Q, system.states),
            Illustration(
                "quadratic",
                "Matrix of the common quadratic function",
                "Q(i,j) / sqrt(Q(i,i) Q(j,j)): the diagonal becomes one and the states lose their "
                "units. An entry near 1 or -1 says that two states act together in V.",
                draw_quadratic(Q, system.states),
            ),
            _rate_table(system, rates, order, evidence),
            Illustration(
                "mode-rates",
                "Decrease in every mode",
                _rates_caption(system, len(names)),
                draw_mode_rates(names, rates[order], float(evidence.rate), system.time),
            ),
        ),
    )


def scaled_matrix(evidence: CommonQuadratic) -> Array:
    """Return Q in floating point, divided by its largest entry."""
    largest = max(abs(entry) for row in evidence.Q for entry in row)
    return np.array([[entry / largest for entry in row] for row in evidence.Q])


def hardest_modes(system: SwitchedSystem, Q: Array | None, limit: int) -> SwitchedSystem:
    """Keep the modes that decay the slowest, at most so many, in the order of the system."""
    if len(system.modes) <= limit:
        return system
    if Q is None:
        slowest = _slowest_first(eigenvalues(system), system.time)
    else:
        rates = mode_rates(system, Q)
        slowest = np.argsort(rates if system.time is Time.CONTINUOUS else -rates, kind="stable")
    kept = np.sort(slowest[:limit])
    return replace(system, modes=tuple(system.modes[i] for i in kept))


def _slowest_first(values: NDArray[np.complex128], time: Time) -> NDArray[np.int64]:
    measure = values.real if time is Time.CONTINUOUS else np.abs(values)
    return np.argsort(-measure.max(axis=1), kind="stable")


def _table(
    system: SwitchedSystem, values: NDArray[np.complex128], listed: NDArray[np.int64]
) -> Table:
    continuous = system.time is Time.CONTINUOUS
    rows = []
    for i in np.sort(listed):
        row = sorted(values[i].tolist(), key=lambda z: -(z.real if continuous else abs(z)))
        worst = row[0].real if continuous else abs(row[0])
        shown = roots(row[:_MANY_STATES], 5) + (" …" if len(row) > _MANY_STATES else "")
        rows.append((system.modes[i].name, shown, number(worst, 5)))
    unit = " [1/s]" if continuous else ""
    size = "Largest real part [1/s]" if continuous else "Largest modulus"
    some = "" if len(rows) == len(system.modes) else f", the {len(rows)} slowest of them"
    title = f"The {len(system.modes)} modes{some}" if len(system.modes) > 1 else "The one mode"
    return Table(title, ("Mode", f"Eigenvalues{unit}", size), tuple(rows))


def _caption(system: SwitchedSystem, drawn: int, rate: float | None) -> str:
    some = "" if drawn == len(system.modes) else f" The {drawn} slowest modes are drawn."
    if system.time is Time.CONTINUOUS:
        text = "A mode is stable if all its eigenvalues lie left of the imaginary axis"
        border = "; all lie left of the dashed line, the proved rate." if rate is not None else "."
    else:
        text = "A mode is stable if all its eigenvalues lie inside the unit circle"
        border = "; all lie inside the dashed circle, the proved contraction." if rate else "."
    return f"{text}{border} Stable modes alone do not make switching stable.{some}"


def _cost_of_other_norm(Q: Array) -> str:
    spectrum = np.linalg.eigvalsh(Q)
    factor = float(np.sqrt(spectrum[-1] / spectrum[0])) if spectrum[0] > 0 else float("inf")
    return (
        "In the Euclidean norm of the states, in their units, the bound holds with the factor "
        f"{number(factor, 3)} in front (the root of Q's condition number)."
    )


def _matrix_table(Q: Array, states: tuple[str, ...]) -> list[Block]:
    if len(Q) > _WRITTEN:
        return []
    rows = tuple(
        (state, *(number(v, 5) for v in row)) for state, row in zip(states, Q, strict=True)
    )
    return [Table("Q divided by its largest entry", ("", *states), rows)]


def _rate_table(
    system: SwitchedSystem, rates: Array, order: NDArray[np.int64], evidence: CommonQuadratic
) -> Table:
    continuous = system.time is Time.CONTINUOUS
    claimed = float(evidence.rate)
    rows = []
    for i in order:
        slack = rates[i] - claimed if continuous else claimed - rates[i]
        rows.append((system.modes[i].name, number(rates[i], 6), number(slack, 3)))
    unit = " [1/s]" if continuous else " [1]"
    own = "Decay rate in the norm of Q" if continuous else "Contraction in the norm of Q"
    some = "" if len(rows) == len(system.modes) else f" ({len(rows)} with the least slack)"
    text = rate_text(evidence.rate, system.time)
    title = f"Rate of every mode alone{some}; claimed for all: {text}{' 1/s' if continuous else ''}"
    return Table(title, ("Mode", f"{own}{unit}", f"Slack{unit}"), tuple(rows))


def _rates_caption(system: SwitchedSystem, shown: int) -> str:
    some = "" if shown == len(system.modes) else f" The {shown} modes with the least slack."
    if system.time is Time.CONTINUOUS:
        return (
            "Half the smallest eigenvalue of -(A'Q + QA) relative to Q: the rate at which the norm "
            f"of Q decays at least in this mode. All lie right of the claimed rate.{some}"
        )
    return (
        "Root of the largest eigenvalue of A'QA relative to Q: the factor by which the norm of Q "
        f"shrinks at least in a step of this mode. All lie left of the claimed contraction.{some}"
    )
