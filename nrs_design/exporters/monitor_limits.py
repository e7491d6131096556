"""Limits of a running loop in single precision, as `audit` has them for a log."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

from nrs_design.controllers.float32 import float32_not_above, to_float32
from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.sector import Sector, sector_of
from nrs_design.exporters.export import Export
from nrs_design.exporters.record import ExportRecord
from nrs_design.exporters.region import MonitoredRegion, region_of
from nrs_design.spec import InteractionDesignSpec

# Longer than any processor runs.
FOREVER = 2**32 - 1


@dataclass(frozen=True, slots=True)
class MonitorLimits:
    """Limits of a loop."""

    period: Fraction  # Sample time in s
    torque: Fraction  # Largest torque in N m
    command: Fraction | None  # Where the command saturates; None where the spec does not say
    age: tuple[int, int] | None  # Smallest and largest age of the force sample, in samples
    stays: tuple[tuple[int, int], ...]  # Shortest and longest time in each mode, in samples
    follows: tuple[tuple[bool, ...], ...]  # For each mode, which may follow it
    sector: Sector | None  # Bounds on torque and angle; None without them in the spec
    # Region of decay with a saturating command; None without a proof of one.
    region: MonitoredRegion | None
    # How far the joint moves, at the limit of its velocity, between two torques that are read.
    travel: Fraction
    left_out: tuple[str, ...]  # What is not monitored, and why


def monitor_limits(export: Export, law: StepLaw) -> MonitorLimits:
    """Return what the loop of an export must keep."""
    record, spec, modes = export.shipped(), export.spec, law.modes
    assert spec is not None
    assert record.sample_time is not None
    period, allowed = Fraction(record.sample_time.exact), spec.switching.of_a_run.transitions
    command = spec.limits.command
    region = region_of(export, law)
    sector, (youngest, oldest) = sector_of(spec), record.delay or (0, 0)
    return MonitorLimits(
        period=to_float32(period),
        torque=float32_not_above(spec.limits.torque.not_above),
        command=None if command is None else float32_not_above(command.not_above),
        age=record.delay,
        stays=tuple(_stay(spec, name, period) for name in modes),
        follows=tuple(
            tuple(allowed is None or a == b or (a, b) in allowed for b in modes) for a in modes
        ),
        sector=None if isinstance(sector, str) else sector,
        region=None if isinstance(region, str) else region,
        travel=spec.limits.velocity.not_below * period * (1 + oldest - youngest),
        left_out=_left_out(spec, record, sector, region),
    )


def _stay(spec: InteractionDesignSpec, name: str, period: Fraction) -> tuple[int, int]:
    shortest, longest = spec.switching.of_a_run.stay(name)
    return (
        0 if shortest is None else ceil(shortest.value / period),
        FOREVER if longest is None else floor(longest.value / period),
    )


def _left_out(
    spec: InteractionDesignSpec,
    record: ExportRecord,
    sector: Sector | str,
    region: MonitoredRegion | str,
) -> tuple[str, ...]:
    said = []
    if isinstance(sector, str):
        said.append(f"Stiffness, and whether contact is kept: {sector}.")
    if isinstance(region, str):
        said.append(f"The region of a proof in which the command saturates: {region}.")
    if spec.limits.command is None:
        said.append("Saturation: the spec has no `limits: command`.")
    if record.delay is None:
        said.append("Age of the force sample: the spec has no `sampling`.")
    if spec.sampling is not None and spec.sampling.misses is not None:
        said.append(
            "How many deadlines are missed, and what is commanded then: a period without a step "
            "is a longer step of time here, and beyond what the caller accepts."
        )
    if spec.switching.names_contacts:
        said.append("Rules of switching that name contacts: what is touched is not known.")
    return (
        *said,
        "Dead time of the motion: `nrs-design audit` fits it to a log. Noise of the torque: its "
        "largest value counts as it is read.",
    )
