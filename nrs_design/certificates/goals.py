"""Goals that a certificate must show: target, proved value, and whether it suffices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from nrs_design.certificates.bounds import bound_on
from nrs_design.certificates.certificate import Certificate, Verdict
from nrs_design.models.axis import find_axis
from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.mode import Time
from nrs_design.spec.faults import Location

if TYPE_CHECKING:
    from nrs_design.proof.system import SwitchedSystem
    from nrs_design.spec import Quantity, Spec
    from nrs_design.spec.sampling import SamplingSpec

N = TypeVar("N", Fraction, float)
_FREE = "optimize says which gains come nearest"


@dataclass(frozen=True, slots=True)
class CertifiedGoal:
    """One goal of a spec that a certificate must show."""

    key: str  # Key of the goal in the spec, such as ``decay_rate``
    wanted: str  # As the spec writes it; ``largest`` wants no number
    said: str  # What is proved; numbers are rounded to their safe side
    # Whether the proved value suffices; otherwise more may be true.
    met: bool

    @property
    def place(self) -> Location:
        """Keys that lead to it in the spec."""
        return "goals", self.key

    @property
    def line(self) -> str:
        """The goal, and what is proved of it, in a line."""
        ends = "PROVED" if self.met else "NOT PROVED"
        return f"goal {self.key}, {self.wanted}: {ends}: {self.said}"


def certified_goals(spec: Spec, certificate: Certificate | None) -> Iterator[CertifiedGoal]:
    """Yield the goals that what is proved decides, in exact arithmetic.

    The certificate has been checked; None if nothing was shown.
    """
    for goal in _goals(spec, certificate):
        # Specs with goals have loaded this module before.
        from nrs_design.controllers.gains import steering_goals

        others = not goal.met and goal.key in steering_goals(spec)
        yield replace(goal, said=f"{goal.said}; {_FREE}") if others else goal


def _goals(spec: Spec, certificate: Certificate | None) -> Iterator[CertifiedGoal]:
    # An `isinstance` would load the class with all its parts, for specs without goals.
    if spec.kind != "interaction-design" or (goals := spec.goals) is None:
        return
    if (torque := goals.peak_torque) is not None:
        yield CertifiedGoal("peak_torque", torque.text, *_peak_torque(torque, certificate))
    if (rate := goals.decay_rate) is not None:
        yield CertifiedGoal("decay_rate", rate.text, *_decay_rate(rate, certificate))
    if (delay := goals.delay) is not None and spec.sampling is not None:
        yield CertifiedGoal("delay", delay.text, *_delay(spec.sampling, delay, certificate))
    if (force := goals.initial_force) is not None:
        required, text = (None, force) if isinstance(force, str) else (force.exact, force.text)
        yield CertifiedGoal("initial_force", text, *_initial_force(required, certificate))


def _peak_torque(required: Quantity, certificate: Certificate | None) -> tuple[str, bool]:
    found = None
    if certificate is not None:
        found = bound_on(certificate.system, certificate.statements, "force")
    if certificate is None or found is None:
        return "no bound on the force was proved", False
    acting = (f"|{c.name}| <= {rounded_down(c.bound, c.unit)}" for c in found.channels)
    statement = (
        f"while {', '.join(acting)} and nothing else disturbs, the force is proved to stay below "
        f"{rounded_up(found.level, _effort(certificate))}, from rest"
    )
    if certificate.system.contact is None:
        statement += ", while contact is kept"
    return statement, found.level <= required.exact


def _effort(certificate: Certificate) -> str:
    """Return the unit of a force on the axis."""
    return find_axis(certificate.system.states).unit("N*m")


def _decay_rate(required: Quantity, certificate: Certificate | None) -> tuple[str, bool]:
    rate = decay_rate(certificate)
    if certificate is None or rate is None:
        return "no decay rate in 1/s was proved", False
    statement = f"the proved decay rate is {rounded_down(rate, '1/s')}"
    if certificate.system.saturation is not None:
        statement += " while no signal saturates"
    return statement, rate >= required.exact


def decay_rate(certificate: Certificate | None) -> Fraction | None:
    """Return the proved rate in 1/s, as `rate_per_second` does; None if nothing was shown."""
    evidence = None if certificate is None else certificate.evidence
    if certificate is None or evidence is None:
        return None
    return rate_per_second(evidence.proved_rate(certificate.system), certificate.system)


def rate_per_second(rate: N | None, system: SwitchedSystem) -> N | None:
    """Return a rate of a system in 1/s; None without a rate or a period.

    Of a contraction rho per step, ``(1 - rho)`` over the period is not above it.
    """
    if rate is None or system.time is Time.CONTINUOUS:
        return rate
    return None if system.sample_time is None else (1 - rate) / system.sample_time


def _delay(
    sampling: SamplingSpec, required: Quantity, certificate: Certificate | None
) -> tuple[str, bool]:
    if certificate is None or certificate.verdict != Verdict.PROVED:
        return "nothing was proved", False
    youngest, oldest = (n * sampling.outer for n in certificate.ages or sampling.delay)
    ages = f"{rounded_up(youngest, 's')} to {rounded_down(oldest, 's')} old"
    return f"the loop is proved for force samples {ages}", oldest >= required.exact


def _initial_force(required: Fraction | None, certificate: Certificate | None) -> tuple[str, bool]:
    statements = () if certificate is None else certificate.statements
    level = next((size for s in statements if (size := s.start_size) is not None), None)
    if certificate is None or level is None:
        return "no force was proved from which motions decay although signals saturate", False
    statement = (
        f"from rest with a contact force up to {rounded_down(level, _effort(certificate))} "
        "motions are proved to decay although signals saturate"
    )
    return statement, required is None or level >= required
