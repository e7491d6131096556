"""Chapters 5 and 6 about modes: their matrices, eigenvalues, and stability under switching."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from fractions import Fraction

import numpy as np

from nrs_design.controllers.laws import Admittance, ProportionalForce
from nrs_design.loop.modes import Rows, position_mode, replace_last, velocity_mode
from nrs_design.models.contact import Elastic
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.models.linear_form import LinearForm, coordinates
from nrs_design.models.motion_loop import Realization, realize
from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.spectrum import is_stable
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certification import Certification
from nrs_design.search.certify import certify
from nrs_design.search.family import Family
from nrs_design.search.gradient import (
    Coordinates,
    Gradient,
    GradientResult,
    Order,
    find_by_gradient,
)
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Number, Recomputed, Result, format_number

MOTION = realize(thesis.REALIZED_LOOP)


def impedance_rows(stiffness: Fraction, Mt: str, Bt: str, coordinates: str) -> Rows:
    """Return A of an impedance mode (thesis 6.28), with deflection or force as the last state.

    The stiffness is in N m/rad, Mt in kg m^2, Bt in N m s/rad.
    """
    environment = Elastic(stiffness)
    rows = velocity_mode(MOTION, Admittance(Fraction(Mt), Fraction(Bt)), environment)
    return rows if coordinates == "deflection" else replace_by_force(rows, MOTION, environment)


def replace_by_force(rows: Rows, motion: Realization, contact: AbstractLinearLaw) -> Rows:
    """Replace the last state delta by the force ``F = k delta + b Cp xp``."""
    last = coordinates(len(rows))[-1:]
    return replace_last(rows, contact.react(motion.output(len(rows)), last)[0])


def hybrid_rows() -> tuple[Rows, Rows]:
    """Return A of the position mode and of the force mode (thesis 6.44 and 6.46)."""
    force = position_mode(MOTION, ProportionalForce(thesis.FORCE_GAIN), Elastic(thesis.SOFT))
    return [list(row) for row in MOTION.A], force


def printed_rows(damping: str, force: tuple[str, str]) -> Rows:
    """Return an A of 6.3.2.2 or 6.4.1 digit by digit: entries (3, 3), (4, 1) and (4, 2) vary."""
    texts = (
        ("0", "1", "0", "0"),
        ("1618.80", "-56.89", "-1", "0"),
        ("0", "0", damping, "100"),
        (*force, "0", "0"),
    )
    return [[Fraction(text) for text in row] for row in texts]


def family(name: str, *modes: Rows) -> SwitchedSystem:
    """Return the switched system of some matrices."""
    items = tuple(Mode(f"A{i + 1}", RationalMatrix.from_rows(rows)) for i, rows in enumerate(modes))
    states = tuple(f"x{i + 1}" for i in range(len(modes[0])))
    return SwitchedSystem(
        name=name, time=Time.CONTINUOUS, states=states, modes=items, assumptions=()
    )


def modes() -> Iterator[Result]:
    """Recompute the matrices entry by entry, and their eigenvalues."""
    num, den = thesis.EXACT_LOOP.numerator, thesis.EXACT_LOOP.denominator
    yield -den[2] / den[0], -den[1] / den[0]
    yield num[1] / den[0], num[0] / den[0]
    soft = impedance_rows(thesis.SOFT, "0.01", "2.15", "force")
    stiff = impedance_rows(thesis.STIFF, "0.01", "2.11", "force")
    yield float(MOTION.A[1][0])
    yield _floats(soft[3][:2])
    yield _floats(stiff[3][:2])
    yield from _floats((soft[2][2], soft[3][0], soft[3][1]))
    yield _spectrum(printed_rows("-215", ("70183.13", "1231.97")))
    yield _not_hurwitz(printed_rows("-104", ("70183.13", "1231.97")))
    yield _not_hurwitz(printed_rows("-211", ("99820.9", "1752.22")))
    yield _not_hurwitz(printed_rows("-410", ("79666.19", "1222.89")))
    for Bt in ("2.15", "1.04"):
        yield _spectrum(impedance_rows(thesis.SOFT, "0.01", Bt, "deflection"))


def _not_hurwitz(rows: Rows) -> Recomputed:
    system = family("printed", rows)
    found = ", ".join(map(format_number, _spectrum(rows)))
    return Recomputed(found, not is_stable(system.modes[0].A, system.time))


def _spectrum(rows: Rows) -> tuple[Number, ...]:
    """Return the eigenvalues, rightmost first, one for each complex pair."""
    found = np.linalg.eigvals(np.array(rows, dtype=float))
    upper = sorted(found[found.imag >= 0], key=lambda z: (-z.real, z.imag))
    return tuple(complex(z) if z.imag else float(z.real) for z in upper)


def _floats(entries: LinearForm) -> tuple[float, ...]:
    return tuple(map(float, entries))


def switching() -> Iterator[Recomputed]:
    """Prove or refute every claim about stability under switching, exactly."""
    for system in (withdrawal(), family("hybrid", *hybrid_rows()), tool_and_tissue()):
        found = certify(system)
        yield Recomputed(_describe(found), found.verdict == "proved")
    force = ("70183.13", "1231.97")
    found = certify(family("print", printed_rows("-215", force), printed_rows("-104", force)))
    yield Recomputed(_describe(found), found.verdict == "refuted")
    massless, massive = certify(withdrawal("0")), certify(withdrawal())
    text = f"Mt = 0: {_describe(massless)}; Mt = 0.01: {_describe(massive)}"
    yield Recomputed(text, massless.verdict == massive.verdict == "proved")


def withdrawal(Mt: str = "0.01") -> SwitchedSystem:
    """Return the pair of 6.3.2.2 with the right signs, in the states of the thesis."""
    insertion, leaving = (impedance_rows(thesis.SOFT, Mt, Bt, "force") for Bt in ("2.15", "1.04"))
    return family("withdrawal", insertion, leaving)


def tool_and_tissue() -> SwitchedSystem:
    """Return the pair of 6.4.1 with the right digits, in the states of the thesis."""
    tool = impedance_rows(thesis.STIFF, "0.01", "2.11", "force")
    return family("tool", tool, impedance_rows(thesis.SOFT, "0.01", "2.15", "force"))


def _describe(result: Certification) -> str:
    rate = result.evidence.proved_rate(result.system) if result.evidence else None
    if rate is None:
        return str(result.verdict)
    return f"{result.verdict}, {rate_words(rate, result.system.time)}"


# Updates of a row: enough for every run that ends in the scan below.
UPDATES, FEW_UPDATES = 20_000, 2000
# One radius of many; the thesis prints none.
RADIUS = 1e5


def pairs() -> tuple[tuple[str, SwitchedSystem], ...]:
    """Return section and system of the three pairs, in the states of the thesis."""
    return (
        ("6.3.2.2", withdrawal()),
        ("6.3.3.2", family("hybrid", *hybrid_rows())),
        ("6.4.1", tool_and_tissue()),
    )


def gradient() -> Iterable[Result]:
    """Run the iteration on all pairs, in the states of the thesis and in others."""
    return (
        _result(system, coordinates, ends=section == "6.3.3.2" or coordinates != Coordinates.GIVEN)
        for section, system in pairs()
        for coordinates in reversed(Coordinates)
    )


def run(
    system: SwitchedSystem,
    coordinates: Coordinates = Coordinates.GIVEN,
    radius: float = RADIUS,
    order: Order = Order.ROUND_ROBIN,
    updates: int = UPDATES,
    start: int = 0,
) -> GradientResult:
    """Run the iteration once with the settings of `Gradient`."""
    settings = Gradient(
        radius=radius, start=start, order=order, coordinates=coordinates, max_updates=updates
    )
    return find_by_gradient(Family.of(system), settings)


def _result(system: SwitchedSystem, coordinates: Coordinates, *, ends: bool) -> Recomputed:
    radius = RADIUS if coordinates == Coordinates.GIVEN else 1.0
    updates = UPDATES if ends else FEW_UPDATES
    found = [run(system, coordinates, radius, order, updates) for order in Order]
    text = ", ".join(
        f"not within {updates:,}" if result.Q is None else f"{result.updates:,}" for result in found
    )
    # One of two orders suffices: rounding decides which order is quicker.
    return Recomputed(text, any(result.Q is not None for result in found) == ends)
