"""Parameter boxes: one mode for each corner, exactly.

A matrix that is affine in the parameters is, anywhere in the box, a convex combination of its
corners. What decreases in all corners in continuous time therefore decreases in the whole box.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.errors import InternalError
from nrs_design.loop.constant_parameters import ConstantParameter
from nrs_design.loop.located import MatrixMode
from nrs_design.loop.spot import Spot, labelled_ends, spot_of
from nrs_design.models.interval import Interval
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.switching import FixedParameter
from nrs_design.spec import ModeSpec, SwitchedSystemSpec


@dataclass(frozen=True, slots=True)
class UncertainParameter:
    """An uncertain number."""

    name: str  # As in the spec
    interval: Interval  # Range of its values
    varies: bool  # True: varies arbitrarily fast; False: unknown but constant


def read_parameters(spec: SwitchedSystemSpec, scale: Fraction) -> tuple[UncertainParameter, ...]:
    """Return the parameters of a spec, their ranges scaled about the nominal values."""
    return tuple(
        UncertainParameter(name, Interval(p.nominal, *p.range).scaled(scale), p.varies)
        for name, p in spec.parameters.items()
    )


def constant_parameters(
    parameters: Sequence[UncertainParameter],
) -> tuple[ConstantParameter, ...]:
    """Return the parameters that are unknown but constant."""
    return tuple(
        ConstantParameter(
            FixedParameter(p.name, p.interval.low, p.interval.high),
            (f"{p.name}-min", f"{p.name}-max"),
        )
        for p in parameters
        if not p.varies and p.interval.low != p.interval.high
    )


def corner_modes(
    mode: ModeSpec, parameters: Sequence[UncertainParameter]
) -> tuple[MatrixMode, ...]:
    """Return the corners of one mode; parameters that it does not depend on make none.

    An `InternalError` if the matrix halfway is not the mean of the corners.
    """
    own = {p.name: p.interval for p in parameters if p.name in mode.parameters}
    others = {p.name: p.interval.nominal for p in parameters}
    corners = [(labels, mode.matrix(others | at)) for labels, at in labelled_ends(own)]
    middle = mode.matrix({p.name: p.interval.middle for p in parameters})
    sums = [
        [sum(column) for column in zip(*rows, strict=True)]
        for rows in zip(*(A for _, A in corners), strict=True)
    ]
    if [[len(corners) * entry for entry in row] for row in middle] != sums:
        raise InternalError(f"mode {mode.name} is not affine in the parameters")
    head, constants = Spot.named(mode.name), constant_parameters(parameters)
    return tuple(
        MatrixMode(
            mode.name, head + spot_of(labels, own, constants), "", RationalMatrix.from_rows(A)
        )
        for labels, A in corners
    )
