"""Bound on the command of a sampled motion loop, for a driver that saturates.

While the command stays below the limit of the driver, the driver does nothing but what the model
says. So a bound on the command from rest, below the limit, shows that the limit is not met from
rest under the same disturbances: saturation is then not left out of the bounds, but excluded.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product

from nrs_design.controllers.float32 import float32_not_above
from nrs_design.loop.program import INPUTS
from nrs_design.loop.sampled import NOTHING, SampledLoop
from nrs_design.models.linear_form import LinearForm
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.channels import Channel, Output
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.spec.motion import MOTOR_COMMAND


def motor_command(
    largest: Fraction | None,
    unit: str,
    loop: SampledLoop,
    channels: Sequence[Channel],
) -> tuple[tuple[Output, ...], tuple[Assumption, ...]]:
    """Return the command under disturbances, roundings included, and what it leaves out.

    Impedance controllers change the reference after the command, so it is one and the same form of
    the states in all modes, in contact and free. A rounding is at most a share of other forms, so
    the command is a mixture of rows in which every share is added or subtracted. Nothing without
    disturbances or a limit, or where it is not of this form.
    """
    moving = all(law.law.commands == "velocity" for law in loop.program.laws)
    if largest is None or not channels or not moving or loop.calendar.holds:
        return (), ()
    sample = loop.sample(loop.program.laws[0], loop.calendar.ages[0], NOTHING)
    form, n = sample.command, len(loop.states)
    end = n + len(INPUTS)
    bounds = {channel.name: channel.bound for channel in channels}
    shares = list(zip(form[end:], sample.sizes, strict=True))
    # What the disturbances of a sample add to its command at once, at most.
    at_once = _largest(form[n:end], bounds) + sum(
        (abs(c) * _largest(size[n:end], bounds) for c, size in shares), Fraction(0)
    )
    rounded = [[c * v for v in size[:n]] for c, size in shares if c and any(size[:n])]
    rows = tuple(
        RationalMatrix.from_rows([[sum(column) for column in zip(form[:n], *signed, strict=True)]])
        for signed in product(*([row, [-v for v in row]] for row in rounded))
    )
    limit = float32_not_above(largest)
    left = limit - at_once
    name = f"{MOTOR_COMMAND} before errors of its sample" if at_once else MOTOR_COMMAND
    output = Output(name, unit, rows, left if left > 0 else None)
    assumption = Assumption.create(
        "not-quantized.command",
        limit=rounded_down(limit, unit),
        less=at_once > 0 and "errors",
        at_once=at_once > 0 and rounded_up(at_once, unit),
        output=name,
    )
    return (output,), (assumption,)


def _largest(form: LinearForm, bounds: dict[str, Fraction]) -> Fraction:
    """Return the largest value of a form of the inputs; inputs without a bound are zero."""
    sizes = (abs(c) * bounds.get(name, Fraction(0)) for name, c in zip(INPUTS, form, strict=True))
    return sum(sizes, Fraction(0))
