"""Inputs of the state (disturbances, rounding errors), and outputs."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.proof.matrix import RationalMatrix


@dataclass(frozen=True, slots=True)
class Channel:
    """A disturbance d that acts on the state: ``x' = A x + B d``, or ``x+ = A x + B d``."""

    # Quantity, such as ``velocity command`` in ``rad/s``.
    name: str
    unit: str
    bound: Fraction  # Largest size at every time; in discrete time, at every step
    # Shape (n, 1). B of every mode, then of every free mode.
    columns: tuple[RationalMatrix, ...]


@dataclass(frozen=True, slots=True)
class Output:
    """A quantity: one of some rows times the state, within a range any mixture of them."""

    # Quantity, such as ``force`` in ``N*m``.
    name: str
    unit: str
    # Shape (1, n). At the corners of its ranges. In free motion the deflection counts as zero.
    rows: tuple[RationalMatrix, ...]
    limit: Fraction | None = None  # Limit of its size; for words only


@dataclass(frozen=True, slots=True)
class Rounding:
    """An error r of an operation of the law: ``x+ = A x + B d + C r``, ``|r| <= |q (x, d)|``."""

    name: str  # Rounded operation, such as ``Kp e``
    # Shape (n, 1). C of every mode, then of every free mode.
    columns: tuple[RationalMatrix, ...]
    # Shape (1, n + number of channels). The q of every mode, and after them those of the free
    # modes, over the state and all disturbances of the system; in free motion nothing in them
    # stands for the deflection.
    rows: tuple[RationalMatrix, ...]
