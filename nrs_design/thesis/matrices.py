"""The state matrices of chapter 6, as printed and as they follow from the loops."""

from __future__ import annotations

from fractions import Fraction

from nrs_design.controllers.laws import Admittance, ProportionalForce
from nrs_design.loop.modes import (
    Rows,
    position_mode,
    to_force_coordinates,
    velocity_mode,
)
from nrs_design.models.contact import Elastic
from nrs_design.models.motion_loop import realize
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.thesis import thesis

MOTION = realize(thesis.REALIZED_LOOP)


def impedance_rows(stiffness: Fraction, Mt: str, Bt: str, coordinates: str) -> Rows:
    """Return A of an impedance mode (thesis 6.28), with deflection or force as the last state.

    The stiffness is in N m/rad, Mt in kg m^2, Bt in N m s/rad.
    """
    environment = Elastic(stiffness)
    rows = velocity_mode(MOTION, Admittance(Fraction(Mt), Fraction(Bt)), environment)
    return rows if coordinates == "deflection" else to_force_coordinates(rows, MOTION, environment)


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
    named = tuple(Mode(f"A{i + 1}", RationalMatrix.from_rows(rows)) for i, rows in enumerate(modes))
    states = tuple(f"x{i + 1}" for i in range(len(modes[0])))
    return SwitchedSystem(
        name=name, time=Time.CONTINUOUS, states=states, modes=named, assumptions=()
    )
