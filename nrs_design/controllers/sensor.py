"""The force sensor: the lags of its filter, and how far its signal may be off for long."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from math import comb

from nrs_design.controllers.float32 import exact_decimal, round_float32
from nrs_design.controllers.taylor import exponential_between
from nrs_design.errors import DesignError
from nrs_design.models.axis import AxisType
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.bounds import rounded_up
from nrs_design.spec.sensor import SensorSpec

ZERO = Fraction(0)


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
        """Denominator of the transfer function, highest power of s first; the numerator is 1."""
        powers = ((1 / self.pole) ** k * comb(self.order, k) for k in range(self.order, -1, -1))
        return tuple(map(float, powers))

    def respond(
        self, force: LinearForm, states: Sequence[LinearForm]
    ) -> tuple[LinearForm, list[LinearForm]]:
        """Return the filtered force, in N m at the sensor, and the rates of the `states`."""
        sources = (force, *states)
        rates = [
            combine((self.pole, before), (-self.pole, state))
            for before, state in zip(sources, states, strict=False)
        ]
        return states[-1], [*rates]

    def discretize(self, period: Fraction) -> DiscreteLowPass:
        """Discretize each lag for an input that is held over a period in s.

        A `DesignError` if a step forgets nothing, so that the force never arrives.
        """
        factor = round_float32(exponential_between(-self.pole * period)[0])
        if factor == 1:
            raise DesignError(
                "the filter of the force is lost in single precision: a step keeps all it holds",
                remedy="raise its cutoff, or sample with a longer period",
                at=("sensor", "filter", "cutoff"),
            )
        return DiscreteLowPass(self.order, factor, round_float32(1 - factor))


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

    # Steady-state error bounds by source: torques about the pivot in N m.
    errors: Mapping[str, Fraction] = field(default_factory=dict)
    filter: LowPass | None = None  # Filter of the signal

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


def build_sensor(spec: SensorSpec | None) -> Sensor:
    """Convert what a spec says of the sensor; without it, the force is exact."""
    if spec is None:
        return Sensor()
    errors = {}
    if spec.bias is not None:
        errors["bias"] = spec.bias.exact
    if spec.resolution is not None:
        errors["half a step of resolution"] = spec.resolution.exact / 2
    low_pass = None
    if spec.filter is not None:
        low_pass = LowPass(spec.filter.order, round_float32(spec.filter.cutoff.not_below))
    return Sensor(errors, low_pass)
