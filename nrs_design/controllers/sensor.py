"""The force sensor: the lags of its filter, and how far its signal may be off for long.

All errors are torques about the pivot. A wrench ``(F, T)`` that is measured at the sensor is the
torque ``T - p x F`` about a pivot at p. The weight of the tool is taken off with the nominal mass
and center of mass; what is left is the weight of what they miss, and that of the nominal tool in
the wrong direction: by an angle e, at most ``2 sin(e/2) <= e`` of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import product
from math import comb, isqrt

from nrs_design.axis import AxisType
from nrs_design.controllers.float32 import exact_decimal, to_float32
from nrs_design.controllers.taylor import exponential_between
from nrs_design.errors import DesignError
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.bounds import rounded_up
from nrs_design.spec.quantity_fields import RangedQuantity
from nrs_design.spec.sensor import SensorSpec, ToolSpec

ZERO = Fraction(0)
Vector = Sequence[Fraction]
# Roots are taken in parts of a nanometer and less.
_FINE = 10**24


@dataclass(frozen=True, slots=True)
class LowPass:
    """Equal lags in a row, ``x1' = w (F - x1)``, ``x2' = w (x1 - x2)``, ...; the last is used."""

    order: int  # How many
    pole: Fraction  # The corner frequency w in rad/s, a single-precision number

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units of the states."""
        return tuple(f"filtered {i} [N*m]" for i in range(1, self.order + 1))

    @property
    def denominator(self) -> tuple[float, ...]:
        """Of the transfer function, whose numerator is 1: highest power of s first."""
        powers = ((1 / self.pole) ** k * comb(self.order, k) for k in range(self.order, -1, -1))
        return tuple(map(float, powers))

    def respond(
        self, force: LinearForm, states: Sequence[LinearForm]
    ) -> tuple[LinearForm, list[LinearForm]]:
        """Return the filtered force, in N m at the sensor, and the rates of the `states`."""
        sources = (force, *states)
        rates = [
            combine((self.pole, before), (-self.pole, own))
            for before, own in zip(sources, states, strict=False)
        ]
        return states[-1], [*rates]

    def discretize(self, period: Fraction) -> DiscreteLowPass:
        """Discretize each lag for an input that is held over a period in s.

        A `DesignError` if a step forgets nothing, so that the force never arrives.
        """
        keep = to_float32(exponential_between(-self.pole * period)[0])
        if keep == 1:
            raise DesignError(
                "the filter of the force is lost in single precision: a step keeps all it holds",
                remedy="raise its cutoff, or sample with a longer period",
                at=("sensor", "filter", "cutoff"),
            )
        return DiscreteLowPass(self.order, keep, to_float32(1 - keep))


@dataclass(frozen=True, slots=True)
class DiscreteLowPass:
    """What a processor computes at every sample: ``x1 = p x1 + q F``, ``x2 = p x2 + q x1``, ...

    Each lag takes what the one before it has just computed, and the law takes the last.
    """

    order: int  # How many lags
    # p, q: single-precision numbers without unit.
    p: Fraction
    q: Fraction


@dataclass(frozen=True, slots=True)
class Sensor:
    """A force sensor, in exact numbers that are not too small."""

    # What may last, by where it comes from: bounds on torques about the pivot in N m.
    errors: Mapping[str, Fraction] = field(default_factory=dict)
    filter: LowPass | None = None  # Of the signal
    noisy: bool = False  # Whether a power density of noise is given, which is in no bound
    carries: bool = False  # Whether a tool hangs on it

    @property
    def lasting(self) -> Fraction:
        """Bound on the lasting error of the torque about the pivot, N m."""
        return sum(self.errors.values(), ZERO)

    def assumptions(
        self, period: Fraction | None, *, disturbed: bool, axis: AxisType = AxisType.ROTARY
    ) -> Iterator[Assumption]:
        """Yield how the law gets the force, and what a proof leaves out of its errors.

        The period is that of the processor in s, if there is one; `disturbed`: bounds on
        disturbances are stated.
        """
        if self.filter is not None:
            order = self.filter.order
            row = {"lags": "one"} if order == 1 else {"lags": "row", "order": str(order)}
            if period is None:
                yield Assumption.create(
                    "sensor.filter", **row, pole=exact_decimal(self.filter.pole)
                )
            else:
                step = self.filter.discretize(period)
                numbers = {"p": exact_decimal(step.p), "q": exact_decimal(step.q)}
                yield Assumption.create("sensor.sampled-filter", **row, **numbers)
        if self.errors:
            unit = axis.unit("N*m")
            yield Assumption.create(
                "sensor.errors-disturbed" if disturbed else "sensor.errors",
                lasting=rounded_up(self.lasting, unit),
                parts=tuple(f"{name}: {rounded_up(e, unit)}" for name, e in self.errors.items()),
            )
        if self.carries:
            yield Assumption.create("sensor.tool")
        if self.noisy:
            yield Assumption.create("sensor.noise")


def build_sensor(spec: SensorSpec | None) -> Sensor:
    """Convert what a spec says of the sensor; without it, the force is exact."""
    if spec is None:
        return Sensor()
    pivot = (ZERO,) * 3 if spec.pivot is None else spec.pivot.exact
    low_pass = None
    if spec.filter is not None:
        low_pass = LowPass(spec.filter.order, to_float32(spec.filter.cutoff.not_below))
    return Sensor(
        dict(_errors(spec, pivot)),
        low_pass,
        spec.noise_density is not None,
        spec.tool is not None,
    )


def _errors(spec: SensorSpec, pivot: Vector) -> Iterator[tuple[str, Fraction]]:
    if spec.bias is not None:
        yield "bias", spec.bias.exact
    if spec.force_bias is not None:
        yield "bias of the force", spec.force_bias.exact * length_above(pivot)
    if spec.drift is not None and spec.tared_every is not None:
        yield "drift since taring", spec.drift.exact * spec.tared_every.exact
    if spec.resolution is not None:
        yield "half a step of resolution", spec.resolution.exact / 2
    if spec.tool is None:
        return
    missed, nominal = _moments(spec.tool, pivot)
    if missed:
        yield "mass and center of mass of the tool", missed
    for name, angle in (("pose", spec.pose_error), ("IMU", spec.imu_error)):
        if angle is not None:
            yield f"weight of the tool at the error of the {name}", nominal * angle.not_below


def _moments(tool: ToolSpec, pivot: Vector) -> tuple[Fraction, Fraction]:
    """Return the weight times arm that the nominal tool misses at most, and its own, in N m."""
    center = (tool.center_of_mass.x, tool.center_of_mass.y, tool.center_of_mass.z)
    mass = tool.mass.nominal.exact
    off, own = [], []
    for axis, origin in zip(center, pivot, strict=True):
        moment = mass * (axis.nominal.exact - origin)
        ends = product(_ends(tool.mass), _ends(axis))
        off.append(max(abs(m * (at - origin) - moment) for m, at in ends))
        own.append(moment)
    gravity = tool.gravity.exact
    return gravity * length_above(off), gravity * length_above(own)


def _ends(written: RangedQuantity) -> tuple[Fraction, ...]:
    return tuple(end.exact for end in written.range)


def length_above(vector: Vector) -> Fraction:
    """Return a fraction not below the length of a vector, and next to it."""
    square = sum((c * c for c in vector), ZERO) * _FINE**2
    root = isqrt(square.numerator // square.denominator)
    exact = root * root * square.denominator == square.numerator
    return Fraction(root + (not exact), _FINE)
