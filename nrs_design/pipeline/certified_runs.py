"""Certified bounds and rates beside a simulated run, and why they may not apply to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Certificate
from nrs_design.pipeline.design import Designed

if TYPE_CHECKING:
    from nrs_design.pipeline.scenarios import Simulated


@dataclass(frozen=True, slots=True)
class CertifiedBound:
    """A certified bound beside a run."""

    # output, unit: what is bounded.
    output: str
    unit: str
    level: float  # Not below what is proved
    # What happens in the run that the proof says nothing about; empty if the bound holds for it.
    uncovered: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class CertifiedRate:
    """A certified rate of decay beside a run."""

    rate: float  # Not better than what is proved: in 1/s, or the factor per sample
    unit: str  # ``1/s``, or empty for a factor
    attained: bool  # Whether it is proved itself, not only what is slower
    start: float | None  # From when on nothing is commanded, in s; None where the run ends before
    uncovered: tuple[str, ...]  # Why it is not about the run from then on; empty if it is


def hold_bounds(
    designed: Designed, certificate: Certificate, simulated: Simulated
) -> tuple[CertifiedBound, ...]:
    """Return the certified bounds with the reasons why they do not apply to a run."""
    from nrs_design.proof.bounds import upper_float
    from nrs_design.simulation.coverage import Coverage

    system, found = certificate.system, []
    for statement in certificate.statements:
        bound = statement.bound(system)
        # One bound for each output is about all disturbances at once.
        if bound is None or set(bound.channels) != set(system.channels):
            continue
        beside = Coverage(designed.spec, system, statement, simulated.scenario, simulated.run)
        reasons, level = tuple(beside.uncovered()), upper_float(bound.level)
        found.append(CertifiedBound(bound.output.name, bound.output.unit, level, reasons))
    return tuple(found)


def hold_rate(
    designed: Designed, certificate: Certificate, simulated: Simulated
) -> CertifiedRate | None:
    """Return the certified rate, if any, with the reasons why it does not apply to a run."""
    from nrs_design.proof.bounds import lower_float, upper_float
    from nrs_design.proof.evidence.abstract import Shows
    from nrs_design.proof.mode import Time
    from nrs_design.simulation.coverage import Coverage, end_of_command

    system, one = certificate.system, simulated
    evidence = certificate.evidence
    proved = None if evidence is None else evidence.proved_rate(system)
    if evidence is None or evidence.shows is not Shows.STABILITY or proved is None:
        return None
    continuous = system.time is Time.CONTINUOUS
    beside = Coverage(designed.spec, system, evidence, one.scenario, one.run)
    return CertifiedRate(
        (lower_float if continuous else upper_float)(proved),
        "1/s" if continuous else "",
        evidence.attains_rate,
        end_of_command(one.scenario),
        tuple(beside.undecayed()),
    )
