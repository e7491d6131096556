"""Matrices as users hold them, read exactly: a float is the binary number that it is."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from numbers import Rational, Real
from typing import Any

from nrs_design.errors import SpecError
from nrs_design.proof.exact import common_denominator
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.text import quoted
from nrs_design.spec.exact import parse_exact

# That of doubles has at most 1074.
MAX_DENOMINATOR_BITS = 2048


def read_rows(matrix: object, name: str = "the matrix") -> list[list[Fraction]]:
    """Read a matrix as exact rows: NumPy, lists of numbers or texts, or a state space's A."""
    array = getattr(matrix, "A", matrix) if is_state_space(matrix) else matrix
    rows = array.tolist() if hasattr(array, "tolist") else array
    if not isinstance(rows, Sequence) or isinstance(rows, str) or not rows:
        raise _no_matrix(name, array)
    if any(not isinstance(row, Sequence) or isinstance(row, str) for row in rows):
        raise _no_matrix(name, array)
    if any(len(row) != len(rows[0]) or not row for row in rows):
        raise SpecError(
            f"{name} has rows of different lengths", remedy="give all rows the same length"
        )
    return [[read_number(entry, name) for entry in row] for row in rows]


def read_matrix(matrix: object, name: str = "the matrix") -> RationalMatrix:
    """Read a matrix over its least common denominator; see `read_rows`."""
    return exact_matrix(read_rows(matrix, name), name)


def exact_matrix(rows: Sequence[Sequence[Fraction]], name: str = "the matrix") -> RationalMatrix:
    """Bring rows over their least common denominator, of at most 2048 binary digits."""
    common = common_denominator(entry.denominator for row in rows for entry in row)
    if common is None or common.bit_length() > MAX_DENOMINATOR_BITS:
        raise SpecError(
            f"the common denominator of {name} has more than {MAX_DENOMINATOR_BITS} binary digits",
            remedy="write its entries with fewer digits",
        )
    return RationalMatrix.from_rows(rows)


def read_number(value: object, name: str = "the value") -> Fraction:
    """Return the exact value of a number: of a text in decimal, of a float in binary."""
    if isinstance(value, str | Decimal):
        return parse_exact(str(value))
    if isinstance(value, bool) or not isinstance(value, Real):
        raise SpecError(
            f"{name} holds {quoted(repr(value))}, which is not a real number",
            remedy='give integers, floats, fractions or texts such as "0.1" and "1/3"',
        )
    if isinstance(value, Rational):
        return Fraction(int(value.numerator), int(value.denominator))
    number = float(value)
    if not isfinite(number) or number != value:
        raise SpecError(
            f"{name} holds {value}, which is not a finite double-precision number",
            remedy="give a finite float, or the exact number as text",
        )
    return Fraction(number)


def is_state_space(value: object) -> bool:
    """Tell whether an object is a state space as python-control has them: with A and dt."""
    return hasattr(value, "A") and hasattr(value, "dt")


def time_of(modes: Sequence[object], time: str | None) -> Time:
    """Return the time of some modes: as said, or as the state spaces among them say.

    Their dt says it: zero is continuous, None undetermined, a period or True discrete. Two sources
    that disagree are a `SpecError`.
    """
    if time not in (None, "continuous", "discrete"):
        raise SpecError(
            f"the time {quoted(str(time))} is not known", remedy="continuous or discrete"
        )
    periods: list[Any] = [getattr(mode, "dt", None) for mode in modes if is_state_space(mode)]
    known = [period for period in periods if period is not None]
    domains = {Time.CONTINUOUS if period == 0 else Time.DISCRETE for period in known}
    # True means a step of unspecified length, although True == 1.
    steps = {period for period in known if period is not True}
    if time is not None:
        domains.add(Time(time))
    if len(domains) > 1 or len(steps) > 1:
        raise SpecError(
            "the modes are not of one time axis",
            remedy="give state spaces of one sample time dt, and the same time if it is given too",
        )
    return domains.pop() if domains else Time.CONTINUOUS


def _no_matrix(name: str, value: object) -> SpecError:
    remedy = "give rows of numbers"
    if hasattr(value, "dt"):
        remedy = "of a system, give the state space: control.ss(system)"
    elif hasattr(value, "value"):
        remedy = "of a variable of CVXPY, give its .value"
    return SpecError(f"{name} is not a matrix", remedy=remedy)
