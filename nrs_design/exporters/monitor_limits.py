"""Limits of a running loop in single precision, as `audit` has them for a log.

The region is that of a regional certificate, which proves decay from ``w' Q w <= 1`` although the
command saturates. The monitor knows some entries of w from the law, and encloses the others by what
it reads: the deflection by torque and stiffness, older torques by older angles, and the speed by
how far the joint went in the last period under the command that it sent. With the motor of the
proof, ``E = exp(-T/tau)`` and ``a = E/(tau (1 - E))``, that is ``omega = a way + Km (1 - a T) u``.
For an entry within h of c, every row of ``U`` times w is at most ``|U c| + |U| h``, and ``U'U`` is
more than Q by `ROOM`, which is kept for what single precision rounds.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor
from operator import mul

import numpy as np

from nrs_design.controllers.float32 import float32_not_above, float32_not_below, round_float32
from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.sector import Sector, sector_of
from nrs_design.controllers.taylor import exponential_between
from nrs_design.exporters.export import Export
from nrs_design.exporters.record import ExportRecord
from nrs_design.proof.evidence import Shows
from nrs_design.proof.exact import IntegerMatrix, is_positive_definite
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.build_plant import build_environments, build_plant
from nrs_design.spec.controllers import contact_names

# Longer than any processor runs.
FOREVER = 2**32 - 1


@dataclass(frozen=True, slots=True)
class MonitorLimits:
    """Limits of a loop."""

    period: Fraction  # Sample time in s
    torque: Fraction  # Largest torque in N m
    command: Fraction | None  # Saturation limit; None without one in the spec
    age: tuple[int, int] | None  # Smallest and largest age of the force sample, in samples
    dwell_times: tuple[tuple[int, int], ...]  # Shortest and longest time in each mode, in samples
    successors: tuple[tuple[bool, ...], ...]  # For each mode, which may follow it
    sector: Sector | None  # Bounds on torque and angle; None without them in the spec
    # Proved region of decay with a saturating command, or None.
    region: MonitoredRegion | None
    # Travel of the joint between two torque readings, at the velocity limit.
    travel: Fraction
    left_out: tuple[str, ...]  # Unmonitored effects, with reasons


def monitor_limits(export: Export, law: StepLaw) -> MonitorLimits:
    """Return what the loop of an export must keep."""
    record, spec, modes = export.shipped(), export.spec, law.modes
    assert spec is not None
    assert record.sample_time is not None
    period, transitions = Fraction(record.sample_time.exact), spec.switching.of_a_run.transitions
    command = spec.limits.command
    region = region_of(export, law)
    sector, (youngest, oldest) = sector_of(spec), record.delay or (0, 0)
    return MonitorLimits(
        period=round_float32(period),
        torque=float32_not_above(spec.limits.torque.not_above),
        command=None if command is None else float32_not_above(command.not_above),
        age=record.delay,
        dwell_times=tuple(_stay(spec, name, period) for name in modes),
        successors=tuple(
            tuple(transitions is None or a == b or (a, b) in transitions for b in modes)
            for a in modes
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
    sentences = []
    if isinstance(sector, str):
        sentences.append(f"Stiffness, and whether contact is kept: {sector}.")
    if isinstance(region, str):
        sentences.append(f"The region of a proof in which the command saturates: {region}.")
    if spec.limits.command is None:
        sentences.append("Saturation: the spec has no `limits: command`.")
    if record.delay is None:
        sentences.append("Age of the force sample: the spec has no `sampling`.")
    if spec.sampling is not None and spec.sampling.misses is not None:
        sentences.append(
            "How many deadlines are missed, and what is commanded then: a period without a step "
            "is a longer step of time here, and beyond what the caller accepts."
        )
    if spec.switching.names_contacts:
        sentences.append("Rules of switching that name contacts: what is touched is not known.")
    return (
        *sentences,
        "Dead time of the motion: `nrs-design audit` fits it to a log. Noise of the torque: its "
        "largest value counts as it is read.",
    )


# Margin for roundings, over V. Entries and rows lose some 2^-24 of themselves.
ROOM = Fraction(1, 64)
_NO_INITIAL_FORCE = (
    "the certificate has no `initial_force`, from which motions decay although commands saturate"
)


@dataclass(frozen=True, slots=True)
class MonitoredRegion:
    """Numbers of the test, of single precision."""

    # Shape (n, n). The U, upper triangular.
    rows: tuple[tuple[Fraction, ...], ...]
    # For each entry of w how it is known: ``law.name``, ``error``, ``speed``, ``torque 1`` of the
    # sample before, or ``deflection``.
    entries: tuple[str, ...]
    yields: tuple[Fraction, Fraction]  # One over the largest and the least stiffness, rad/(N m)
    stiffness: tuple[Fraction, Fraction]  # The least and the largest, N m/rad
    ways: tuple[Fraction, Fraction]  # The least and the largest a, in 1/s
    gains: tuple[Fraction, Fraction]  # The least and the largest Km
    samples: int  # Number of earlier angles that the test needs


def region_of(export: Export, law: StepLaw) -> MonitoredRegion | str:
    """Return the region of the proof, or why it is not monitored; the law is the one that ships."""
    certificate, spec, design = export.certificate, export.spec, export.design
    if certificate is None or spec is None or design is None:
        return _NO_INITIAL_FORCE
    regions = (item for item in certificate.statements if item.shows is Shows.REGION)
    evidence, system = next(regions, None), certificate.system
    if evidence is None or evidence.quadratic is None or system.sample_time is None:
        return _NO_INITIAL_FORCE
    if spec.sampling is None or spec.sampling.jitter is not None:
        return "periods are not of one length, and the speed is not known from the way of one"
    if max(spec.late) > 0:
        return "commands take effect late, and the speed is not known from the way of a period"
    stored = {value.stored: f"law.{value.name}" for value in law.states if value.stored}
    names = {value.name for value in law.states}
    known = stored | {"omega [rad/s]": "speed", "delta [rad]": "deflection"}
    known |= {"e [rad]": "error"} if "reference" in names else {}
    oldest = export.shipped().delay or (0, 0)
    known |= {f"F {j} before [N*m]": f"torque {j}" for j in range(1, oldest[1] + 1)}
    if spec.offset != "none" or any(name not in known for name in system.states):
        return "a state of it counts from a rest that the monitor does not know"
    if any(c.law.commands == "position" for c in design.controllers):
        return "under position and force control it counts from a rest that it does not know"
    rows = _factor(*evidence.quadratic)
    if rows is None:
        return "single precision loses it"
    T, motor = system.sample_time, build_plant(spec).actuator_ranges
    ways = [
        E / (tau * (1 - E))
        for tau in (motor.time_constant.low, motor.time_constant.high)
        for E in exponential_between(-T / tau)
    ]
    contacts = {name for c in spec.controllers.values() for name in contact_names(c.contacts)}
    found = [e.stiffness for e in build_environments(spec) if e.name in contacts]
    low, high = min(k.low for k in found), max(k.high for k in found)
    return MonitoredRegion(
        rows,
        tuple(known[name] for name in system.states),
        (float32_not_above(1 / high), float32_not_below(1 / low)),
        (float32_not_above(low), float32_not_below(high)),
        (float32_not_above(min(ways)), float32_not_below(max(ways))),
        (float32_not_above(motor.gain.low), float32_not_below(motor.gain.high)),
        max(1, oldest[1]),
    )


def _factor(form: IntegerMatrix, power: int) -> tuple[tuple[Fraction, ...], ...] | None:
    """Return U with ``U'U > Q`` of single precision, checked exactly; None where none is found."""
    target = [[Fraction(v, 2**power) for v in row] for row in form]
    scale = np.array([float(row[i]) ** 0.5 for i, row in enumerate(target)])
    unit = np.array([[float(v) for v in row] for row in target]) / np.outer(scale, scale)
    U = np.linalg.cholesky(unit * float(1 + ROOM)).T * scale
    rows = tuple(tuple(round_float32(Fraction(float(v))) for v in row) for row in U)
    columns = [*zip(*rows, strict=True)]
    surplus = [
        [sum(map(mul, a, b)) - (1 + ROOM / 2) * v for b, v in zip(columns, row, strict=True)]
        for a, row in zip(columns, target, strict=True)
    ]
    return rows if is_positive_definite(RationalMatrix.from_rows(surplus).numerators) else None
