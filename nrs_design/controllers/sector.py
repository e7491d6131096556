"""Conditions on readings of torque and angle, for a stiffness within a range.

At every sample there is a stiffness ``k`` in ``[low, high]``, of its own, with the torque
``k max(angle - surface, 0)`` (``k (angle - surface)`` where contact is kept); readings are off by
bounded noise. So each sample leaves an interval of surfaces; where the intervals of one contact
have no point in common, no stiffness explains them. The theorem is in docs/exports/monitor.md.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.build_plant import build_environments
from nrs_design.spec.controllers import contact_names
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.sensor import Surface

# A sample counts as judged if a stiffness beyond the range by this factor had been reported.
DETECTION_FACTOR = Fraction(3, 2)


@dataclass(frozen=True, slots=True)
class Sector:
    """Bounds on the readings, in exact conservative numbers."""

    low: Fraction  # Least stiffness in N m/rad
    high: Fraction  # Largest one
    torque_noise: Fraction  # Largest error of the torque in N m, with what damping adds
    angle_noise: Fraction  # Largest angle error in rad, including skew and surface motion
    reading: Fraction  # Largest error of the angle as it is read, in rad
    surface: Surface  # When the surface may be elsewhere
    surface_speed: Fraction  # Largest speed of the surface in rad/s
    contact_maintained: bool  # Contact is never lost, so the tissue pulls as well
    speed: Fraction | None  # Largest speed of the joint in rad/s; None if unknown

    def noise(self) -> Fraction:
        """Return the distance in rad by which noise parts two readings of one surface."""
        yields = 1 / self.low + 1 / self.high
        return 4 * self.angle_noise + 2 * self.torque_noise * yields

    def need(
        self, factor: Fraction, travel: Fraction = Fraction(0), rounding: Fraction = Fraction(0)
    ) -> Fraction:
        """Return the smallest torque, in N m, at which every violation is detected despite noise.

        `factor` is the stiffness over its range: over the upper end above one, the lower end below.
        In rad: how far the joint moves between two torques that are read, and rounding the same
        surface.
        """
        if factor > 1:
            k = factor * self.high
            gain, lever = 1 / self.high - 1 / k, 1 / self.low - 1 / k
        else:
            k = factor * self.low
            gain, lever = 1 / k - 1 / self.low, 1 / k - 1 / self.high
        # The other sample is the last one in free motion if the surface stays where that shows it,
        # else the first one with certain contact.
        if factor > 1 and self.surface != "touched" and not self.contact_maintained:
            return (self.noise() + rounding + travel) / gain
        minimum_torque = k * travel + (0 if self.contact_maintained else 2 * self.torque_noise)
        return (self.noise() + rounding + minimum_torque * lever) / gain


def sector_of(spec: InteractionDesignSpec) -> Sector | str:
    """Return the conditions on readings of a run, or the reason for none."""
    monitoring = spec.monitoring
    if monitoring is None:
        return "the spec has no `monitoring`, so nothing says how far readings are off"
    if spec.contact is None:
        return "the spec does not say by `contact` whether contact may be lost"
    youngest, oldest = (0, 0) if spec.sampling is None else spec.sampling.delay
    if monitoring.surface != "fixed" and oldest - youngest > 1:
        return "ages of the force sample differ by more than one, so the order of contacts is lost"
    names = {name for c in spec.controllers.values() for name in contact_names(c.contacts)}
    environments = [e for e in build_environments(spec) if e.name in names]
    if not environments:
        return "no controller touches anything"
    for e in environments:
        if e.law.has_memory or e.law.has_mass or e.preloaded:
            return f"the torque of {e.name} does not follow from angle and speed of the moment"
    damping = max(e.load[1].high for e in environments)
    if damping and monitoring.speed is None:
        return "a tissue has damping, and no `monitoring: speed` bounds what that adds"
    speed, skew, drift = map(
        _not_below, (monitoring.speed, monitoring.skew, monitoring.surface_speed)
    )
    # The surface moves on while the sample of the torque grows old.
    age = Fraction(0) if spec.sampling is None else spec.sampling.oldest
    reading = monitoring.angle_noise.not_below
    return Sector(
        low=min(e.stiffness.low for e in environments),
        high=max(e.stiffness.high for e in environments),
        torque_noise=monitoring.torque_noise.not_below + damping * speed,
        angle_noise=reading + speed * skew + drift * (age + skew),
        reading=reading,
        surface=monitoring.surface,
        surface_speed=drift,
        contact_maintained=spec.contact == "kept",
        speed=None if monitoring.speed is None else speed,
    )


def _not_below(quantity: Quantity | None) -> Fraction:
    return Fraction(0) if quantity is None else quantity.not_below
