"""Parameter boxes: one mode for each corner, exactly.

A matrix that is affine in the parameters is, anywhere in the box, a convex combination of its
corners. What decreases in all corners in continuous time therefore decreases in the whole box.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from nrs_design.errors import InternalError
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.switching import FixedParameter
from nrs_design.spec import ModeSpec, SwitchedSystemSpec
from nrs_design.spec.interval import Interval

Rows = Sequence[Sequence[Fraction]]


@dataclass(frozen=True, slots=True)
class UncertainParameter:
    """An uncertain number."""

    name: str  # As in the spec
    interval: Interval  # Where it lies
    varies: bool  # Whether it may change arbitrarily fast; otherwise it is unknown but constant


@dataclass(frozen=True, slots=True)
class Corner:
    """One assembled mode among those that stand for one mode of the spec."""

    mode: str  # Name of the assembled mode, such as ``a/k-min``
    end: str = ""  # End of the constant parameter, if there is one


def read_parameters(spec: SwitchedSystemSpec, scale: Fraction) -> tuple[UncertainParameter, ...]:
    """Return the parameters of a spec, their ranges scaled about the nominal values."""
    return tuple(
        UncertainParameter(name, Interval(p.nominal, *p.range).scaled(scale), p.varies)
        for name, p in spec.parameters.items()
    )


def fixed_parameter(parameters: Sequence[UncertainParameter]) -> FixedParameter | None:
    """Return the parameter that is unknown but constant, if there is one."""
    for name, interval, varies in ((p.name, p.interval, p.varies) for p in parameters):
        if not varies and interval.low != interval.high:
            return FixedParameter(name, interval.low, interval.high)
    return None


def corner_modes(
    mode: ModeSpec, parameters: Sequence[UncertainParameter]
) -> tuple[tuple[Mode, ...], tuple[Corner, ...]]:
    """Return the corners of one mode.

    Parameters
    ----------
    mode : ModeSpec
        With entries that are affine in the parameters.
    parameters : sequence of UncertainParameter
        All parameters of the spec. Those that the mode does not depend on make no corners, except
        the constant one: its two ends make pairs in every mode.

    Returns
    -------
    tuple of tuples
        The assembled modes, and what they stand for.

    Raises
    ------
    InternalError
        If the matrix halfway is not the mean of the corners.
    """
    axes = [p for p in parameters if p.name in mode.parameters or not p.varies]
    others = {p.name: p.interval.nominal for p in parameters}
    modes, corners, matrices = [], [], []
    for ends in product(*(p.interval.ends for p in axes)):
        labels = [f"{p.name}-{end}" for p, (end, _) in zip(axes, ends, strict=True) if end]
        values = others | {p.name: value for p, (_, value) in zip(axes, ends, strict=True)}
        fixed = [end for p, (end, _) in zip(axes, ends, strict=True) if not p.varies]
        name = "/".join([mode.name, *labels])
        matrices.append(mode.matrix(values))
        modes.append(Mode(name, RationalMatrix.from_rows(matrices[-1])))
        corners.append(Corner(name, *fixed))
    check_affine(mode.matrix({p.name: p.interval.middle for p in parameters}), matrices, mode.name)
    return tuple(modes), tuple(corners)


def check_affine(middle: Rows, corners: Sequence[Rows], name: str) -> None:
    """Check that the matrix in the middle of a box is the mean of its corners.

    Follows from the construction; it is computed again because a proof for the whole box rests
    on it.

    Parameters
    ----------
    middle : rows of Fraction
        The matrix halfway.
    corners : sequence of rows
        The matrices at the corners.
    name : str
        Of the mode, for errors.

    Raises
    ------
    InternalError
        If it is not.
    """
    n = len(middle)
    for i, j in product(range(n), range(n)):
        if middle[i][j] * len(corners) != sum(corner[i][j] for corner in corners):
            raise InternalError(
                f"entry {i + 1}, {j + 1} of mode {name} is not affine in the parameters"
            )


def pair_ends(corners: Sequence[Corner]) -> tuple[tuple[str, str], ...]:
    """Pair the two ends of the constant parameter, all else being equal."""
    low = [corner.mode for corner in corners if corner.end == "min"]
    high = [corner.mode for corner in corners if corner.end == "max"]
    return tuple(zip(low, high, strict=True))
