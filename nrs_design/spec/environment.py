"""Environments that the robot touches, and what their linear parameters are at the pivot."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import Discriminator

from nrs_design.models import contact
from nrs_design.models.axis import AxisType, current
from nrs_design.models.contact.law import DAMPING
from nrs_design.models.interval import Interval, turn
from nrs_design.spec import kinds
from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row, refuse
from nrs_design.spec.faults import Location
from nrs_design.spec.fields import Title
from nrs_design.spec.model import optional, required
from nrs_design.spec.preload import RangedExponent, power_box
from nrs_design.spec.provenance import Coverage, IdentifiedRangesSpec
from nrs_design.spec.quantity import Quantity

_LEVER_ARM = (
    "distance from the pivot to the contact point, a length in m; required if the parameters are "
    "linear (N/m, N*s/m, kg), forbidden otherwise"
)
_STIFFNESS = (
    "stiffness{which} at the pivot in N*m/rad, or at the contact point in N/m with lever_arm; one "
    "quantity, or {{nominal: ..., range: [lowest, highest]}}"
)
_DAMPING = (
    "damping{which} at the pivot in N*m*s/rad, or at the contact point in N*s/m with lever_arm; "
    "one quantity, or {{nominal: ..., range: [lowest, highest]}}"
)
_COVERS = (
    "what the identified ranges hold: confidence (the mean of the specimens), tolerance (95 % of "
    "all specimens) or prediction (the next record), each with 95 %"
)

_LENGTHS = "write lengths with a lever_arm, and angles without one"


class AbstractEnvironmentSpec(IdentifiedRangesSpec, stronger="holding"):
    """Fields that all environments share; the ranged quantities are the parameters of the law."""

    # The law that designs and proofs take, and its own where that is not linear: the former stands
    # for it while the deflection stays in a preload, off its surface, and no more.
    law: ClassVar[type[contact.AbstractLinearLaw]]
    nonlinear: ClassVar[type[contact.AbstractNonlinearLaw] | None] = None

    model: str

    lever_arm: field.LeverArm | None = optional(_LEVER_ARM)
    range_covers: Coverage | None = optional(_COVERS, stronger="neither")
    linearized_about: Title | None = optional(
        "deflections, in words, that a nonlinear law was linearized about", stronger="neither"
    )

    def _without_arm(self) -> Iterator[tuple[Location, str]]:
        """Yield what is linear without a lever arm, about a pivot."""
        if self.lever_arm is None and current() is AxisType.ROTARY:
            for name, quantity in self.ranges.items():
                if is_translational(quantity.nominal):
                    yield (name,), quantity.nominal.text

    def _with_arm(self) -> Iterator[tuple[Location, str]]:
        """Yield rotational parameters of an environment with a lever arm."""
        if self.lever_arm is not None:
            for name, quantity in self.ranges.items():
                if not is_translational(quantity.nominal):
                    yield (name,), quantity.nominal.text

    checks: ClassVar[tuple[Row[Any], ...]] = (
        *IdentifiedRangesSpec.checks,
        Row(
            "lever_arm",
            lambda s: s.lever_arm is not None and current() is AxisType.PRISMATIC,
            "the axis is prismatic, and has no pivot to be at a distance from",
            "remove lever_arm",
        ),
        refuse(
            _without_arm,
            "{0!r} is linear, and there is no lever_arm",
            "add `lever_arm: 0.24 m` (the distance from the pivot to the contact point) or write "
            "the rotational value at the pivot",
        ),
        refuse(
            _with_arm,
            "{0!r} is rotational, and a lever_arm is given",
            "remove lever_arm, or write the linear value (N/m, N*s/m, kg)",
        ),
    )

    @property
    def fixed(self) -> bool:
        """Whether every parameter has a single value."""
        return all(quantity.fixed for quantity in self.ranges.values())

    @property
    def preloaded(self) -> bool:
        """Whether its ranges hold in a preload only."""
        return self.nonlinear is not None

    @property
    def is_spring(self) -> bool:
        """Tell whether the present deflection alone gives the force, over the whole range."""
        if self.law.has_memory or self.law.has_mass:
            return False
        kinds = zip(self.law.keys, self.law.kinds, strict=True)
        damping = (self.ranges[key] for key, kind in kinds if kind == DAMPING)
        return not any(q.exact for each in damping for q in (each.nominal, *each.range))

    @property
    def is_losable(self) -> bool:
        """Tell whether its contact may be lost while others are touched at the same time."""
        return self.is_spring and not self.preloaded

    @property
    def preload_range(self) -> tuple[Quantity, Quantity] | None:
        """Lowest and highest deflection of the preload, if there is a preload."""
        return None

    def linear_at_pivot(self) -> dict[str, Interval]:
        """Return the parameters of that law with their ranges for a rotation."""
        return self.exact_at_pivot()

    def exact_at_pivot(self) -> dict[str, Interval]:
        """Return the parameters with their ranges for a rotation, in N*m/rad and N*m*s/rad.

        With a lever arm r, each value is multiplied by ``r^2``, exactly (thesis 6.3.1.1:
        747.1461 N/m at 0.24 m is 43.0356 N*m/rad).
        """
        radius = Fraction(1) if self.lever_arm is None else self.lever_arm.exact
        each = {name: value.interval for name, value in self.ranges.items()}
        return {
            name: Interval(
                turn(i.nominal, radius), turn(i.low, radius), turn(i.high, radius), i.varies
            )
            for name, i in each.items()
        }

    def drawn_at_pivot(self, pick: Callable[[Interval], float]) -> dict[str, float]:
        """Return one number for each parameter, and whatever else the law takes, for a rotation.

        `pick` takes a range and returns a number within; it is asked in the order of the
        parameters.
        """
        return {name: pick(interval) for name, interval in self.exact_at_pivot().items()}


class ElasticSpec(AbstractEnvironmentSpec):
    """Elastic environment, ``F = k delta`` (thesis 2.5)."""

    law: ClassVar[type[contact.AbstractLinearLaw]] = contact.Elastic

    model: Literal["elastic"] = required("law of the environment: elastic, F = k delta")
    stiffness: field.Stiffness = required(_STIFFNESS.format(which=""))


class KelvinVoigtSpec(AbstractEnvironmentSpec):
    """Kelvin-Voigt environment, ``F = k delta + b ddelta`` (thesis 2.5)."""

    law: ClassVar[type[contact.AbstractLinearLaw]] = contact.KelvinVoigt

    model: Literal["kelvin-voigt"] = required("law: kelvin-voigt, F = k delta + b ddelta/dt")
    stiffness: field.Stiffness = required(_STIFFNESS.format(which=""))
    damping: field.Damping = required(_DAMPING.format(which=""))


class HandSpec(AbstractEnvironmentSpec):
    """A hand that holds the robot, ``F = k delta + b ddelta + m dddelta`` (thesis 7.2)."""

    law: ClassVar[type[contact.AbstractLinearLaw]] = contact.Hand

    model: Literal["hand"] = required(
        "law: hand, F = k delta + b ddelta/dt + m d2delta/dt2; contact is kept"
    )
    stiffness: field.Stiffness = required(_STIFFNESS.format(which=""))
    damping: field.Damping = required(_DAMPING.format(which=""))
    mass: field.HandMass = required(
        "mass at the pivot in kg*m^2, or at the contact point in kg with lever_arm; one quantity, "
        "or {nominal: ..., range: [lowest, highest]}"
    )


class MaxwellSpec(AbstractEnvironmentSpec):
    """Maxwell environment, a spring and a damper in a row: ``F + (b/k) dF = b ddelta``."""

    law: ClassVar[type[contact.AbstractLinearLaw]] = contact.Maxwell

    model: Literal["maxwell"] = required(
        "law: maxwell, F + (b/k) dF/dt = b ddelta/dt; no rest position, so nothing else is touched"
    )
    stiffness: field.Stiffness = required(_STIFFNESS.format(which=" k of the spring"))
    damping: field.PositiveDamping = required(_DAMPING.format(which=" b of the damper, > 0,"))


class KelvinBoltzmannSpec(AbstractEnvironmentSpec):
    """Kelvin-Boltzmann environment, the standard linear solid (thesis 2.5)."""

    law: ClassVar[type[contact.AbstractLinearLaw]] = contact.KelvinBoltzmann

    model: Literal["kelvin-boltzmann"] = required(
        "law: kelvin-boltzmann, a spring k2 in a row with a spring k1 beside a damper b"
    )
    parallel_stiffness: field.Stiffness = required(
        _STIFFNESS.format(which=" k1 of the spring beside the damper,")
    )
    series_stiffness: field.Stiffness = required(
        _STIFFNESS.format(which=" k2 of the spring in a row with both,")
    )
    damping: field.PositiveDamping = required(_DAMPING.format(which=" b of the damper, > 0,"))


class HuntCrossleySpec(AbstractEnvironmentSpec):
    """Hunt-Crossley environment, ``F = rho delta^phi + lam delta^phi ddelta`` (thesis 2.18)."""

    law: ClassVar[type[contact.AbstractLinearLaw]] = contact.KelvinVoigt
    nonlinear = contact.HuntCrossley

    model: Literal["hunt-crossley"] = required(
        "law: hunt-crossley, F = (rho + lam ddelta/dt) delta^phi within the preload"
    )
    stiffness: field.Stiffness = required(
        _STIFFNESS.format(which=" of small motions at the deflection `about`,")
    )
    damping: field.Damping = required(_DAMPING.format(which=" at the deflection `about`,"))
    exponent: RangedExponent = required(
        "phi, 1 to 3, three decimals, no unit; one number, or {nominal: ..., range: [...]}"
    )
    about: field.Deflection = required(
        "deflection of stiffness and damping: a length with lever_arm, else an angle"
    )
    preload: tuple[field.Deflection, field.Deflection] = required(
        "[lowest, highest] deflection, counted from the surface, within which the proof holds"
    )

    def _of_other_kind(self) -> tuple[str, str, str] | None:
        """Return a deflection that is a length without a lever arm, or an angle with one."""
        of_length = kinds.LENGTH.accepts(self.about.dimension)
        if current() is AxisType.PRISMATIC or of_length == (self.lever_arm is not None):
            return None
        found = "a length", "there is no lever_arm"
        return self.about.text, *(found if of_length else ("an angle", "a lever_arm is given"))

    def _off_preload(self) -> tuple[str, str, str] | None:
        """Return `about` and the ends of a preload in the same unit that does not hold it."""
        low, high = self.preload
        if self._units() or low.rational_part <= self.about.rational_part <= high.rational_part:
            return None
        return self.about.text, low.text, high.text

    def _units(self) -> bool:
        """Return whether `about` and the preload have different units."""
        return len({(q.dimension, q.pi_power) for q in (self.about, *self.preload)}) > 1

    checks = (
        *AbstractEnvironmentSpec.checks,
        Row("about", _of_other_kind, "{0!r} is {1}, and {2}", _LENGTHS),
        Row("preload", _units, "about and preload have different units", "use one unit"),
        Row(
            "preload",
            _off_preload,
            "about {0!r} is not within the preload [{1}, {2}]",
            "write [lowest, highest] around it",
        ),
    )

    @property
    def preload_range(self) -> tuple[Quantity, Quantity]:
        """As `preload` says."""
        return self.preload

    @property
    def fixed(self) -> bool:
        """Whether stiffness and damping have single values: never in a preload."""
        return False

    def drawn_at_pivot(self, pick: Callable[[Interval], float]) -> dict[str, float]:
        """Return the tangent, the exponent, and the angle at which the tangent is given."""
        tangent = super().drawn_at_pivot(pick)
        arm = 1.0 if self.lever_arm is None else self.lever_arm.si
        exponent = pick(Interval(self.exponent.nominal, *self.exponent.range))
        return {**tangent, "exponent": exponent, "about": self.about.si / arm}

    def linear_at_pivot(self) -> dict[str, Interval]:
        """Return the box of stiffness and damping over the preload, rounded outwards."""
        tangent, about = self.exact_at_pivot(), self.about.rational_part
        low, high = (end.rational_part / about for end in self.preload)
        box = power_box(tangent["stiffness"], tangent["damping"], self.exponent, (low, high))
        return dict(zip(("stiffness", "damping"), box, strict=True))


EnvironmentSpec = Annotated[
    ElasticSpec | KelvinVoigtSpec | HandSpec | MaxwellSpec | KelvinBoltzmannSpec | HuntCrossleySpec,
    Discriminator("model"),
]
# Laws that a spec may name: laws of designs and nonlinear laws.
ENVIRONMENT_LAWS: tuple[type[contact.AbstractContactLaw], ...] = tuple(
    law
    for model in get_args(get_args(EnvironmentSpec)[0])
    for law in (model.law, model.nonlinear)
    if law is not None
)


# Stiffness, damping and mass at the contact point, with their kinds at the pivot.
_TURNED = (
    (kinds.LINEAR_STIFFNESS, kinds.STIFFNESS),
    (kinds.LINEAR_DAMPING, kinds.DAMPING),
    (kinds.MASS, kinds.HAND_MASS),
)


def unit_at_pivot(quantity: Quantity) -> str:
    """Return the unit of a stiffness, damping or mass at the pivot."""
    return next(
        turned.on(current()).units[0]
        for linear, turned in _TURNED
        if linear.accepts(quantity.dimension) or turned.accepts(quantity.dimension)
    )


def is_translational(quantity: Quantity) -> bool:
    """Tell whether a stiffness, damping or mass is given at the contact point (N/m, N*s/m, kg)."""
    return any(linear.accepts(quantity.dimension) for linear, _ in _TURNED)
