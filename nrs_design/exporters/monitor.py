"""A monitor in C: it tells when a running loop first leaves what its proof is about.

The checks are those of `nrs_design.identification.running`, which holds a log against a spec, as
far as a processor can make them while it runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.exporters.c_names import CNames, block_comment, harmless, literal
from nrs_design.exporters.c_step import FINITE
from nrs_design.exporters.export import Export
from nrs_design.exporters.monitor_limits import MonitorLimits, monitor_limits
from nrs_design.exporters.monitor_source import SOURCE
from nrs_design.exporters.program import Program, program_of
from nrs_design.output import C_MONITOR, C_MONITOR_HEADER

KINDS = {
    "NONE": "Nothing was left",
    "INPUT": "The angle is no number, or no robot gets there, or the mode does not exist",
    "JITTER": "A step of time is off by more than the caller accepts",
    "DELAY": "The torque is older, or younger, than the proof says",
    "STAY": "A mode was left too early or too late",
    "ORDER": "A mode was followed by one that must not follow it",
    "SATURATION": "The command met its limit",
    "FORCE": "The torque is beyond its limit",
    "SPEED": "The axes together are faster than their coupling is known for",
}


def render(export: Export) -> dict[str, bytes]:
    """Return header and source, by their endings.

    Parameters
    ----------
    export : Export
        With a record, proved or not.

    Raises
    ------
    DesignError
        If there is no program of a controller yet.
    """
    program = program_of(export)
    limits = monitor_limits(export, program.law.modes)
    return {
        "_monitor.h": header_text(program, limits).encode(),
        "_monitor.c": source_text(program, limits).encode(),
    }


def header_text(program: Program, limits: MonitorLimits) -> str:
    """Return the header: limits, types and functions.

    Parameters
    ----------
    program : Program
        The law that is monitored.
    limits : MonitorLimits
        What it must keep.
    """
    names = program.names
    guard = f"{names.upper}_MONITOR_H"
    macros = "".join(_macro(*row) for row in _limits(names, limits))
    text = _HEADER.replace("@KINDS@", _kinds(names, limits)).replace("@MACROS@", macros)
    text = text.replace("@SPEED@", "" if limits.speed is None else _SPEED)
    text = text.replace("@GUARD@", guard).replace("@OWN@", names.lower)
    text = text.replace("@UP@", names.upper).replace("@SPEC@", names.spec)
    return block_comment((*program.about, *_words(program, limits)), C_MONITOR_HEADER) + text


def source_text(program: Program, limits: MonitorLimits) -> str:
    """Return the source.

    Parameters
    ----------
    program : Program
        The law that is monitored.
    limits : MonitorLimits
        What it must keep.
    """
    names = program.names
    text = SOURCE.replace("@FINITE@", FINITE)
    text = text.replace("@STAYS@", _tables(program, limits))
    text = text.replace("@CHECKS@", _checks(limits))
    text = text.replace("@OWN@", names.lower).replace("@UP@", names.upper)
    about = (*program.about, f"More is in {names.spec}_monitor.h.")
    return block_comment(about, C_MONITOR) + text.replace("@SPEC@", names.spec)


def _words(program: Program, limits: MonitorLimits) -> Iterator[str]:
    own = program.names.lower
    yield ""
    yield (
        f"Call {own}_monitor_init once, then {own}_monitor_step at every sample, beside "
        f"{own}_step. It returns the first violation, and from then on the same until init. What "
        "to do then is for the caller to say. It commands nothing and is no part of the proof: "
        "silence says nothing of what is not monitored, or happens between samples."
    )
    if limits.speed is not None:
        yield (
            "The axes act on each other, and how much is known below a speed only. It is that of "
            "all axes together, the root of the sum of the squares of their joint speeds, which "
            "the caller knows: one monitor sees one axis. It is judged as it is read."
        )
    yield "Uneven steps of time: no proof knows them. The caller says how much is accepted."
    yield from (f"Not monitored: {text}" for text in limits.left_out)


def macro_numbers(names: CNames, limits: MonitorLimits) -> dict[str, int | Fraction]:
    """Return every macro of the header with its number: what may be left, and limits."""
    kinds = {f"{names.upper}_LEFT_{kind}": k for k, kind in enumerate(_told(limits))}
    return {**kinds, **{name: number for name, number, _ in _limits(names, limits)}}


def _told(limits: MonitorLimits) -> dict[str, str]:
    """Return what may be left: of one axis by itself, no speed."""
    return {k: text for k, text in KINDS.items() if k != "SPEED" or limits.speed is not None}


def _kinds(names: CNames, limits: MonitorLimits) -> str:
    rows = enumerate(_told(limits).items())
    return "".join(f"/* {text}: */\n#define {names.upper}_LEFT_{k} {i}U\n" for i, (k, text) in rows)


def _limits(names: CNames, limits: MonitorLimits) -> Iterator[tuple[str, int | Fraction, str]]:
    """Yield the macro of each limit, its number, and what stands beside it."""
    up = f"{names.upper}_MONITOR"
    yield f"{up}_PERIOD", limits.period, "s"
    yield f"{up}_TORQUE", limits.torque, "N*m, from the spec"
    if limits.command is not None:
        yield f"{up}_COMMAND", limits.command, "from the spec"
    if limits.speed is not None:
        yield f"{up}_SPEED", limits.speed, "rad/s, over all axes, from the spec"
    if limits.age is not None:
        least, most = limits.age
        yield f"{up}_YOUNGEST", least, "samples, from the spec"
        yield f"{up}_OLDEST", most, ""


def _macro(name: str, value: int | Fraction, words: str) -> str:
    if isinstance(value, int):
        return f"#define {name} {value}U /* {words} */\n" if words else f"#define {name} {value}U\n"
    return f"#define {name} {literal(value)} /* {exact_decimal(value)} {words} */\n"


def _tables(program: Program, limits: MonitorLimits) -> str:
    """Write what each mode has."""
    modes, count = program.law.modes, f"{program.names.upper}_MODES"
    allowed = [", ".join("true" if may else "false" for may in row) for row in limits.follows]
    rows = {
        ("uint32_t", "shortest", ""): [f"{n}U" for n, _ in limits.stays],
        ("uint32_t", "longest", ""): [f"{n}U" for _, n in limits.stays],
        ("bool", "follows", f"[{count}]"): [f"{{{row}}}" for row in allowed],
    }
    return "".join(_table(head, each, modes, count) for head, each in rows.items())


def _table(head: tuple[str, str, str], rows: list[str], modes: tuple[str, ...], count: str) -> str:
    type_, name, shape = head
    lines = "".join(
        f"        {row}, /* {harmless(mode)} */\n" for row, mode in zip(rows, modes, strict=True)
    )
    return f"    static const {type_} {name}[{count}]{shape} = {{\n{lines}    }};\n"


def _checks(limits: MonitorLimits) -> str:
    """Write the checks that the spec has a limit for."""
    text = ""
    if limits.age is not None:
        least, _ = limits.age
        young = "(in->age < @UP@_MONITOR_YOUNGEST) || " if least else ""
        text += _check(f"{young}(in->age > @UP@_MONITOR_OLDEST)", "DELAY")
    else:
        text += "    (void)in->age;\n"
    if limits.command is not None:
        below = "(in->command > -@UP@_MONITOR_COMMAND) && (in->command < @UP@_MONITOR_COMMAND)"
        text += _check(f"!({below})", "SATURATION")
    if limits.speed is not None:
        text += _check("!(size_of(in->speed) < @UP@_MONITOR_SPEED)", "SPEED")
    return text


def _check(condition: str, kind: str) -> str:
    return f"    note(m, {condition}, @UP@_LEFT_{kind});\n"


_SPEED = "    float speed; /* rad/s: root of the sum of squares of all joint speeds */\n"
_HEADER = """\

#ifndef @GUARD@
#define @GUARD@

#include "@SPEC@.h"

#include <stdbool.h>
#include <stdint.h>

@KINDS@
/* Limits. */
@MACROS@
/* What the loop measured and commanded in a sample. */
typedef struct {
    uint32_t mode;
    float step; /* s since the sample before; in the first one, the sample time */
    uint32_t age; /* samples: how old the torque is */
    float angle; /* rad */
    float torque; /* N*m */
    float command; /* of the motor */
@SPEED@} @OWN@_monitor_input_t;

/* What it remembers. */
typedef struct {
    float jitter;
    uint32_t left;
    uint32_t sample;
    uint32_t mode;
    uint32_t stay;
    bool begun;
    bool switched;
} @OWN@_monitor_t;

/* Begin anew; steps of time may be off by so many s. */
void @OWN@_monitor_init(@OWN@_monitor_t *m, float jitter);

/* Return what was left first; `sample` counts the samples before it. */
uint32_t @OWN@_monitor_step(
    const @OWN@_monitor_input_t *in,
    @OWN@_monitor_t *m);

#endif
"""
