"""A monitor in C: it reports when a running loop first leaves the assumptions of its proof.

The checks are those of `nrs_design.identification.running`, which holds a log against a spec, as
far as a processor can make them while it runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.export import Export
from nrs_design.exporters.monitor_limits import MonitoredRegion, MonitorLimits, monitor_limits
from nrs_design.exporters.program import Program, program_of
from nrs_design.exporters.sector_numbers import sector_macros, sector_words
from nrs_design.exporters.text import CNames, block_comment, fill_template
from nrs_design.models.axis import unit
from nrs_design.output import C_MONITOR, C_MONITOR_HEADER

FORMAT = Format(
    "C99 that tells when a running loop first leaves its proof; takes the header of c",
    SAMPLED,
    {"_monitor.h": C_MONITOR_HEADER, "_monitor.c": C_MONITOR},
    executable=True,
)

KINDS = {
    "NONE": "Nothing was left",
    "INPUT": "The angle is no number, or no robot gets there, or the mode does not exist",
    "JITTER": "A step of time is off by more than the caller accepts",
    "DELAY": "The torque is older, or younger, than the proof says",
    "STAY": "A mode was left too early or too late",
    "ORDER": "A mode was followed by one that must not follow it",
    "SATURATION": "The command met its limit",
    "FORCE": "The torque is beyond its limit",
    "STIFFNESS": "No stiffness of the range, another one at every sample, explains the readings",
    "PULL": "The torque pulls, which no tissue does",
    "FAST": "The joint is faster than its readings are known for",
    "REGION": "The state may be outside of where motions decay although the command saturates",
}


def render(export: Export) -> dict[str, bytes]:
    """Return header and source, by their endings."""
    program = program_of(export)
    limits = monitor_limits(export, program.law)
    return {
        "_monitor.h": header_text(program, limits).encode(),
        "_monitor.c": source_text(program, limits).encode(),
    }


def header_text(program: Program, limits: MonitorLimits) -> str:
    """Return the header: limits, types and functions."""
    return fill_template(
        "monitor.h.j2",
        comment=block_comment((*program.description, *_words(program, limits)), C_MONITOR_HEADER),
        kinds=list_violations(limits),
        macros=[*_limits(program.names, limits)],
        **_values(program, limits),
    )


def source_text(program: Program, limits: MonitorLimits) -> str:
    """Return the source."""
    successor_rows = [
        f"{{{', '.join('true' if may else 'false' for may in row)}}}" for row in limits.successors
    ]
    tables = [
        ("uint32_t", "shortest", "", [f"{shortest}U" for shortest, _ in limits.dwell_times]),
        ("uint32_t", "longest", "", [f"{longest}U" for _, longest in limits.dwell_times]),
        ("bool", "follows", f"[{program.names.modes}]", successor_rows),
    ]
    description = (*program.description, f"More is in {program.names.spec}_monitor.h.")
    return fill_template(
        "monitor.c.j2",
        comment=block_comment(description, C_MONITOR),
        modes=program.law.modes,
        tables=tables,
        oldest=limits.age[1] if limits.age else 0,
        **_values(program, limits),
    )


def _values(program: Program, limits: MonitorLimits) -> dict[str, Any]:
    """Return what both templates take."""
    names, sector = program.names, limits.sector
    remembered = 0  # Angles before the present one that are needed
    if sector is not None:
        remembered = max(limits.age[1] if limits.age else 0, int(sector.speed is not None))
    return {
        **{"spec": names.spec, "own": names.lower, "up": names.upper},
        **{"limits": limits, "region": limits.region, "remembered": remembered},
    }


def _words(program: Program, limits: MonitorLimits) -> Iterator[str]:
    prefix = program.names.lower
    yield ""
    yield (
        f"Call {prefix}_monitor_init once, then {prefix}_monitor_step at every sample, beside "
        f"{prefix}_step. It returns the first violation, and from then on the same until init. "
        "What to do then is for the caller to say. It commands nothing and is no part of the "
        "proof: silence says nothing of what is not monitored, or happens between samples."
    )
    if limits.region is not None:
        yield (
            "The region: from the states in an ellipsoid, motions are proved to decay although the "
            "command saturates. The state is taken as it is read, the speed from the way of a "
            "period under the motor of the proof; what is not known for certain counts as the "
            "worst. So silence means that it was inside, but for errors of the readings. It is "
            "not tested at the first samples, before angles are known. That the command meets its "
            "limit is no violation then."
        )
    if limits.sector is not None:
        yield from sector_words(limits.sector, limits.travel)
    yield "Uneven steps of time: no proof knows them. The caller says how much is accepted."
    yield from (f"Not monitored: {text}" for text in limits.left_out)


def list_violations(limits: MonitorLimits) -> dict[str, str]:
    """Return kinds of violations with their meanings, in the order of their numbers."""
    sector = limits.sector
    conditions = {
        # Within the region, the command may meet its limit.
        "SATURATION": limits.region is None,
        "REGION": limits.region is not None,
        "STIFFNESS": sector is not None,
        "PULL": sector is not None and not sector.contact_maintained,
        "FAST": sector is not None and sector.speed is not None,
    }
    return {
        kind: text for kind, text in KINDS.items() if kind not in conditions or conditions[kind]
    }


def _limits(names: CNames, limits: MonitorLimits) -> Iterator[tuple[str, int | Fraction, str]]:
    """Yield macro, number and comment of each limit."""
    up = f"{names.upper}_MONITOR"
    yield f"{up}_PERIOD", limits.period, "s"
    yield f"{up}_TORQUE", limits.torque, f"{unit('N*m')}, from the spec"
    if limits.command is not None and limits.region is None:
        yield f"{up}_COMMAND", limits.command, "from the spec"
    if limits.age is not None:
        lowest, highest = limits.age
        yield f"{up}_YOUNGEST", lowest, "samples, from the spec"
        yield f"{up}_OLDEST", highest, ""
    if limits.region is not None:
        for name, number, note in _region_macros(limits.region):
            yield f"{up}_{name}", number, note
    if limits.sector is not None:
        for name, number, note in sector_macros(limits.sector):
            yield f"{up}_{name}", number, note


def _region_macros(region: MonitoredRegion) -> Iterator[tuple[str, Fraction, str]]:
    """Yield the numbers by which the state is read."""
    per = f"{unit('rad/(N*m)')}, at the "
    yield "LEAST_YIELD", region.yields[0], f"{per}largest stiffness"
    yield "MOST_YIELD", region.yields[1], f"{per}least stiffness"
    yield "LEAST_STIFF", region.stiffness[0], unit("N*m/rad")
    yield "MOST_STIFF", region.stiffness[1], unit("N*m/rad")
    yield "WAY_LOW", region.ways[0], "1/s, speed after a period over its way, for a command of zero"
    yield "WAY_HIGH", region.ways[1], "1/s"
    yield "GAIN_LOW", region.gains[0], "of the motor"
    yield "GAIN_HIGH", region.gains[1], "of the motor"
