"""What a running loop is held against, in single precision: as `audit` holds a log against it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

from nrs_design.controllers.float32 import float32_not_above, float32_not_below, to_float32
from nrs_design.exporters.export import Export
from nrs_design.exporters.record import ExportRecord
from nrs_design.identification.running import bounds_of_spec, switching_rules
from nrs_design.identification.statistics import student_quantile
from nrs_design.proof.evidence import Shows
from nrs_design.spec import InteractionDesignSpec

# Of a window of the stiffness, in s; and how many samples it has at least and at most.
WINDOW, FEWEST, MOST = Fraction(1, 2), 20, 500
# Which part of the windows an interval leaves outside, where errors are normal.
CHANCE = 1e-6
# Longer than any processor runs.
FOREVER = 2**32 - 1

Pair = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class MonitorLimits:
    """Limits of a loop.

    Parameters
    ----------
    period : Fraction
        Sample time in s.
    torque : Fraction
        Largest torque in N m.
    command : Fraction or None
        Where the command saturates; None where the spec does not say.
    speed : Fraction or None
        Below which the joint speeds of all axes stay together, in rad/s; None without one.
    age : (int, int) or None
        Smallest and largest age of the force sample, in samples.
    stiffness : tuple
        Ranges for each mode, in N m/rad; none for one that is not judged.
    contact_kept : bool
        Whether contact must be kept.
    stays : tuple of (int, int)
        Shortest and longest time in each mode, in samples.
    follows : tuple of tuple of bool
        For each mode, which may follow it.
    window : int
        Samples of a window of the stiffness.
    quantile : Fraction
        Half width of its interval, in standard errors.
    left_out : tuple of str
        What is not monitored, and why.
    """

    period: Fraction
    torque: Fraction
    command: Fraction | None
    speed: Fraction | None
    age: tuple[int, int] | None
    stiffness: tuple[tuple[Pair, ...], ...]
    contact_kept: bool
    stays: tuple[tuple[int, int], ...]
    follows: tuple[tuple[bool, ...], ...]
    window: int
    quantile: Fraction
    left_out: tuple[str, ...]


def monitor_limits(export: Export, modes: tuple[str, ...]) -> MonitorLimits:
    """Return what the loop of an export must keep.

    Parameters
    ----------
    export : Export
        With a record, proved or not.
    modes : tuple of str
        Controllers, in the order of the program.
    """
    record, spec = export.shipped(), export.spec
    assert spec is not None
    assert record.sample_time is not None
    period, bounds = Fraction(record.sample_time.exact), bounds_of_spec(spec)
    # Free modes of force control are modes like others: no kind of evidence tells them apart.
    losable = bounds.losable or (record.unproved is None and _losable(export))
    window = min(max(round(WINDOW / period), FEWEST), MOST)
    stiffness = {name: _ranges(spec, name) for name in modes}
    allowed = bounds.transitions
    command = spec.limits.command
    speed = None if spec.coupling is None else spec.coupling.speed
    return MonitorLimits(
        period=to_float32(period),
        torque=float32_not_above(spec.limits.torque.not_above),
        command=None if command is None else float32_not_above(command.not_above),
        speed=None if speed is None else float32_not_above(speed.not_above),
        age=record.delay,
        stiffness=tuple(stiffness[name] or () for name in modes),
        contact_kept=not losable,
        stays=tuple(_stay(spec, name, period) for name in modes),
        follows=tuple(
            tuple(allowed is None or a == b or (a, b) in allowed for b in modes) for a in modes
        ),
        window=window,
        quantile=to_float32(Fraction(student_quantile(window - 3, 1 - CHANCE))),
        left_out=_left_out(spec, record, stiffness),
    )


def _losable(export: Export) -> bool:
    """Tell whether what is proved holds while contact is lost."""
    statements = () if export.certificate is None else export.certificate.statements
    return any(s.shows is Shows.STABILITY and s.covers_lost_contact for s in statements)


def _ranges(spec: InteractionDesignSpec, name: str) -> tuple[Pair, ...] | None:
    """Return the stiffness that a controller may meet; None if no window tells."""
    found = bounds_of_spec(spec).stiffness[name]
    if found is None:
        return ()
    if found.foreign:
        return None
    # Inward: what the monitor accepts lies within what was proved.
    ends = ((Fraction(a), Fraction(b)) for a, b in found.ranges)
    return tuple((float32_not_below(a), float32_not_above(b)) for a, b in ends)


def _stay(spec: InteractionDesignSpec, name: str, period: Fraction) -> tuple[int, int]:
    shortest, longest = switching_rules(spec).stay(name)
    return (
        0 if shortest is None else ceil(shortest.value / period),
        FOREVER if longest is None else floor(longest.value / period),
    )


def _left_out(
    spec: InteractionDesignSpec,
    record: ExportRecord,
    stiffness: dict[str, tuple[Pair, ...] | None],
) -> tuple[str, ...]:
    said = []
    if spec.limits.command is None:
        said.append("Saturation: the spec has no `limits: command`.")
    if spec.coupling is not None and spec.coupling.speed is None:
        said.append("Speed over all axes: the spec has no `coupling: speed`, so it is near zero.")
    if record.delay is None:
        said.append("Age of the force sample: the spec has no `sampling`.")
    for name, ranges in stiffness.items():
        if ranges is None:
            said.append(f"Stiffness in {name}: a tissue that remembers has none in a window.")
        elif not ranges:
            said.append(f"Stiffness in {name}: it has no contact.")
    if spec.switching.names_contacts:
        said.append("Rules of switching that name contacts: what is touched is not known.")
    return (
        *said,
        "Dead time of the motion: `nrs-design audit` fits it to a log. Noise of the torque: its "
        "largest value counts as it is read.",
    )
