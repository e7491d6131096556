"""A safety layer between the compliant laws and the reference of the motion controller.

Operations of single precision, as those of a law. It takes the step that the laws want the
reference to make, limits its speed, refuses it where it leads further into contact beyond a limit
of the torque, and where it would do more work against the torque than is left. What is within all
limits passes bit for bit.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction

from nrs_design.controllers.float32 import float32_not_above
from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.errors import DesignError
from nrs_design.spec.safety import SafetySpec

# The step that the laws want, and where its speed is formed.
STEP, SPEED = "moved", "relative"
# Keeps the sign of a product: what exceeds a limit of 1e-6 N m by the least, times the smallest
# step, does not vanish, and no product overflows.
MAGNIFIED = Fraction(2) ** 64
LEAST_TORQUE = Fraction(1, 2**20)


@dataclass(frozen=True, slots=True)
class SafetyLimits:
    """Numbers that ship: none is above what the spec says."""

    speed: Fraction  # rad/s
    torque: Fraction  # N m
    energy: Fraction  # J
    refill: Fraction  # J in a sample

    @classmethod
    def of(cls, spec: SafetySpec, period: Fraction) -> SafetyLimits:
        """Round those of a spec.

        Parameters
        ----------
        spec : SafetySpec
            What is to be kept.
        period : Fraction
            In s.

        Raises
        ------
        DesignError
            If the limit of the torque is lost in single precision.
        """
        power = Fraction(0) if spec.power is None else spec.power.not_above
        found = cls(
            float32_not_above(spec.speed.not_above),
            float32_not_above(spec.torque.not_above),
            float32_not_above(spec.energy.not_above),
            float32_not_above(power * period),
        )
        if found.torque < LEAST_TORQUE:
            raise DesignError(
                "the torque of the safety layer is too small for single precision",
                remedy="give at least 1e-6 N*m",
                at=("safety", "torque"),
            )
        return found


def add_safety(law: StepLaw, limits: SafetyLimits) -> StepLaw:
    """Return a law whose reference a safety layer moves.

    Parameters
    ----------
    law : StepLaw
        Of impedance controllers alone.
    limits : SafetyLimits
        What is kept.
    """
    own = [*_operations(refills=bool(limits.refill))]
    operations: list[Operation] = []
    for operation in law.operations:
        operations += own if operation.name == STEP else (operation,)
    spent = Value("spent", "spent", "J", limits.energy, "energy that the safety layer has booked")
    return replace(
        law,
        states=(*law.states, spent),
        coefficients=(*law.coefficients, *_coefficients(limits)),
        operations=tuple(operations),
        outputs={**law.outputs, "withheld": "withheld"},
        following={**law.following, "spent": "next_spent"},
        units={**law.units, "withheld": "rad"},
    )


def _coefficients(limits: SafetyLimits) -> Iterator[Coefficient]:
    yield Coefficient("safe_speed", "", "rad/s", (limits.speed,))
    yield Coefficient("safe_torque", "", "N*m", (limits.torque,))
    yield Coefficient("safe_energy", "", "J", (limits.energy,))
    if limits.refill:
        yield Coefficient("less_refill", "", "J", (-limits.refill,))
    yield Coefficient("magnified", "", "1", (MAGNIFIED,), inline=True)


def _operations(*, refills: bool) -> Iterator[Operation]:
    """Yield the layer: from the speed that the laws want to the step that is made."""
    yield Operation("safe", "saturate", "safe_speed", SPEED)
    yield Operation("step", "multiply", "T", "safe")
    # Beyond the limit of the torque, it has the other sign than the torque, and else it is zero.
    yield Operation("borne", "saturate", "safe_torque", "torque")
    yield Operation("excess", "subtract", "borne", "torque")
    yield Operation("excess_magnified", "multiply", "magnified", "excess")
    yield Operation("outward", "product", "excess_magnified", "step")
    yield Operation("allowed", "permit", "outward", "step")
    yield Operation("work", "product", "torque", "allowed")
    yield Operation("would_spend", "add", "spent", "work")
    yield Operation("left", "rest", "safe_energy", "would_spend")
    yield Operation(STEP, "permit", "left", "allowed")
    yield Operation("done", "product", "torque", STEP)
    yield Operation("booked", "add", "spent", "done")
    last = "booked"
    if refills:
        last = "refilled"
        yield Operation(last, "shift", "less_refill", "booked")
    yield Operation("next_spent", "permit", last, last)
    yield Operation("asked", "multiply", "T", SPEED)
    yield Operation("withheld", "subtract", "asked", STEP)
