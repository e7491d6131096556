"""What contact with a person may do, held against what is proved of force and speed.

A limit is met only where the certified bound, rounded to the safe side, is not above it. Without
such a bound it is not judged.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.bounds import bound_on
from nrs_design.certificates.certificate import Certificate
from nrs_design.certificates.certified_goal import CertifiedGoal
from nrs_design.models.impact import Impact
from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.mode import Time
from nrs_design.proof.text import exact_text
from nrs_design.spec.contact_limits import CONTACT_LIMITS, IMPACT, LASTING, PRESSURES

if TYPE_CHECKING:
    from nrs_design.proof.evidence.abstract import Bound
    from nrs_design.spec import InteractionDesignSpec
    from nrs_design.spec.contact_limits import ContactLimitSpec
    from nrs_design.spec.quantity import Quantity

_COLLISION = "two masses and a spring, the drive not pushing (ISO/TS 15066 A.3)"


@dataclass(frozen=True, slots=True)
class Certified:
    """A number that is proved to be kept, or why there is none."""

    level: Fraction | None  # In SI
    under: str  # While what it holds; without a level, why nothing is judged


def contact_goals(
    spec: InteractionDesignSpec, certificate: Certificate | None
) -> Iterator[CertifiedGoal]:
    """Yield the limits of contact with people, each with what is proved.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With `limits.contact`, or without.
    certificate : Certificate or None
        Checked; None if nothing was shown.
    """
    if not spec.limits.contact:
        return
    torque, speed = certified_torque(spec, certificate), certified_speed(spec, certificate)
    for index, region in enumerate(spec.limits.contact):
        for key in CONTACT_LIMITS:
            limit: Quantity | Fraction | None = getattr(region, key)
            if limit is None:
                continue
            value = limit if isinstance(limit, Fraction) else limit.exact
            text = exact_text(limit) if isinstance(limit, Fraction) else limit.text
            found = torque if key in LASTING else speed
            said, met = _judge(region, key, value, found)
            at = ("limits", "contact", index, key)
            name = f"contact.{region.name}.{key}"
            yield CertifiedGoal(name, said, text, met, at)


def certified_torque(spec: InteractionDesignSpec, certificate: Certificate | None) -> Certified:
    """Return what is proved of the torque of contact at the pivot, N m.

    Parameters
    ----------
    spec, certificate
        As for `contact_goals`.
    """
    bound, why = _bound(spec, certificate, "force")
    if bound is None:
        return Certified(None, why)
    return Certified(bound.level, _under(bound, certificate))


def certified_speed(spec: InteractionDesignSpec, certificate: Certificate | None) -> Certified:
    """Return what is proved of the angular velocity at which a person may be met, rad/s.

    A safety layer bounds it whatever is commanded; else the bound under all disturbances counts,
    if free motion is covered, as nobody is met in contact that is never lost.

    Parameters
    ----------
    spec, certificate
        As for `contact_goals`.
    """
    found = []
    for item in () if certificate is None else certificate.statements:
        if item.kept_speed is not None:
            under = "whatever is commanded, by the safety layer, from rest"
            found.append(Certified(item.kept_speed, under))
    bound, why = _bound(spec, certificate, "velocity")
    if bound is not None and spec.late_at is not None:
        # Between two samples the speed is then between theirs no longer.
        why = "commands that take effect within a period move the speed between its samples"
    elif bound is not None and certificate is not None and certificate.system.is_losable:
        found.append(Certified(bound.level, _under(bound, certificate)))
    elif bound is not None:
        why = "the bound on the velocity is that of kept contact; write `contact: losable`"
    return min(found, key=lambda c: c.level or 0) if found else Certified(None, why)


def _bound(
    spec: InteractionDesignSpec, certificate: Certificate | None, output: str
) -> tuple[Bound | None, str]:
    """Return the bound on an output under all disturbances, or why none counts."""
    if spec.disturbances is None or spec.disturbances.command is None:
        return None, "no command is declared; add `disturbances: {command: 8 deg/s}`"
    bound = None
    if certificate is not None:
        bound = bound_on(certificate.system, certificate.statements, output)
    return bound, f"no bound on the {output} was proved"


def _under(bound: Bound, certificate: Certificate | None) -> str:
    acting = ", ".join(f"|{c.name}| <= {rounded_down(c.bound, c.unit)}" for c in bound.channels)
    sampled = certificate is not None and certificate.system.time is Time.DISCRETE
    return f"while {acting} and nothing else disturbs, from rest{', at the samples' * sampled}"


def _judge(
    region: ContactLimitSpec, key: str, limit: Fraction, found: Certified
) -> tuple[str, bool]:
    """Say what is proved of a limit, and whether that is enough."""
    if found.level is None:
        return f"not judged: {found.under}", False
    if key in LASTING:
        # Forces at the shortest lever arm.
        force = found.level / region.lever_arm.min.exact
        value = force / _area(region) if key in PRESSURES else force
        said = f"{found.under}, contact with {region.environment} is proved to stay below"
        return f"{said} {_up(value, key)} [{region.source}]", value <= limit
    # Speeds at the longest lever arm, and a region that moves towards the robot.
    own = Fraction(0) if region.body_speed is None else region.body_speed.exact
    speed = found.level * region.lever_arm.max.exact + own
    met_at = rounded_up(speed, "m/s")
    if own == 0:
        met_at += ", itself at rest"
    met_at = f"{found.under}, the region is met at no more than {met_at}"
    if key not in IMPACT:
        return f"{met_at} [{region.source}]", speed <= limit
    value, safe = _impact(region, key, limit, speed)
    said = (
        f"{met_at}: at most {_up(value, key)} of "
        f"{_COLLISION}; the safe speed is {rounded_down(safe, 'm/s')} [{region.source}]"
    )
    return said, value <= limit


def _impact(
    region: ContactLimitSpec, key: str, limit: Fraction, speed: Fraction
) -> tuple[Fraction, Fraction]:
    """Return what an impact does at a speed, and the speed at which it does what is allowed."""
    assert region.robot_mass is not None
    assert region.body_mass is not None
    spring = None if region.stiffness is None else region.stiffness.exact
    impact = Impact(region.robot_mass.exact, region.body_mass.exact, spring)
    if key == "energy":
        return impact.energy(speed), impact.speed_of_energy(limit)
    if key == "hic":
        return impact.hic(speed), impact.speed_of_hic(limit)
    area = _area(region) if key in PRESSURES else Fraction(1)
    return impact.force(speed) / area, impact.speed_of_force(limit * area)


def _area(region: ContactLimitSpec) -> Fraction:
    assert region.contact_area is not None
    return region.contact_area.exact


def _up(value: Fraction, key: str) -> str:
    """Write a number as its limit is written."""
    if key in PRESSURES:
        return rounded_up(value / 10**4, "N/cm^2")
    return rounded_up(value, {"energy": "J", "hic": "of HIC"}.get(key, "N"))
