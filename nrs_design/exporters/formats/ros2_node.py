"""A package of ROS 2: a node that runs the exported C at its rate, with the monitor beside it."""

from __future__ import annotations

import re
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from nrs_design.axis import unit
from nrs_design.controllers.parts import HAND, POSITION, WANTED
from nrs_design.errors import DesignError
from nrs_design.exporters import SAMPLED, Format
from nrs_design.exporters.c_names import block_comment
from nrs_design.exporters.export import Export
from nrs_design.exporters.formats import c, monitor
from nrs_design.exporters.monitor_limits import MonitorLimits, monitor_limits
from nrs_design.exporters.program import Program, program_of
from nrs_design.exporters.record import ExportRecord
from nrs_design.exporters.template import fill_template
from nrs_design.output import (
    C_HEADER,
    C_MONITOR,
    C_MONITOR_HEADER,
    C_SOURCE,
    ROS2_CMAKE,
    ROS2_LAUNCH,
    ROS2_NODE,
    ROS2_PACKAGE,
    ROS2_PAGE,
    ROS2_PARAMETERS,
)
from nrs_design.proof.text import exact_text

_FOLDER = "_ros2/"
FORMAT = Format(
    "a node of ROS 2 that runs the C at its rate, with the monitor beside it",
    SAMPLED,
    {
        f"{_FOLDER}package.xml": ROS2_PACKAGE,
        f"{_FOLDER}CMakeLists.txt": ROS2_CMAKE,
        f"{_FOLDER}README.md": ROS2_PAGE,
        f"{_FOLDER}src/node.cpp": ROS2_NODE,
        f"{_FOLDER}src/NAME.h": C_HEADER,
        f"{_FOLDER}src/NAME.c": C_SOURCE,
        f"{_FOLDER}src/NAME_monitor.h": C_MONITOR_HEADER,
        f"{_FOLDER}src/NAME_monitor.c": C_MONITOR,
        f"{_FOLDER}config/node.yaml": ROS2_PARAMETERS,
        f"{_FOLDER}launch/node.launch.py": ROS2_LAUNCH,
    },
    executable=True,
)
# Texts, and their templates in `templates/ros2`.
_TEMPLATES = MappingProxyType(
    {
        "package.xml": "package.xml",
        "CMakeLists.txt": "CMakeLists.txt",
        "README.md": "README.md",
        "src/node.cpp": "node.cpp",
        "config/node.yaml": "node.yaml",
        "launch/node.launch.py": "launch.py",
    }
)
# By the input of the law: its topic, and the field of a JointState.
_COMMANDS = MappingProxyType(
    {
        "velocity_command": ("servo_jv", "velocity"),
        "position": ("servo_jp", "position"),
        "wanted_torque": ("servo_jf", "effort"),
    }
)
# How much of a sample may pass unnoticed, unless the user says otherwise.
_TOLERANCE = Fraction(1, 20)
_NANO = 10**9
_LEFT = re.compile(r"^#define \w+_LEFT_(\w+) \d+U$", re.MULTILINE)


def render(export: Export) -> dict[str, bytes]:
    """Return all files of the package, by their endings.

    Parameters
    ----------
    export : Export
        With a record, proved or not.

    Raises
    ------
    DesignError
        If there is no program of a controller yet, or its period is no whole number of nanoseconds.
    """
    program = program_of(export)
    code = {**c.render(export), **monitor.render(export)}
    values = _values(program, monitor_limits(export, program.law), code["_monitor.h"])
    texts = {
        name: fill_template(f"ros2/{template}.j2", unit=unit, **values)
        for name, template in _TEMPLATES.items()
    }
    files = {name: text.encode() for name, text in texts.items()}
    files |= {f"src/NAME{ending}": content for ending, content in code.items()}
    return {ending: files[ending.removeprefix(_FOLDER)] for ending in FORMAT.files}


def remarks(files: object) -> tuple[str, ...]:
    """Say what the package was never tried with."""
    del files
    return ("the node was never built against ROS 2 here: README.md of the package says more",)


def _values(program: Program, limits: MonitorLimits, monitor_header: bytes) -> dict[str, Any]:
    record, law = program.record, program.law
    assert record.sample_time is not None
    period = Fraction(record.sample_time.exact)
    inputs = {value.name: value for value in law.inputs}
    # The mode logic sees the velocity that is commanded, also where no law takes it.
    seen = set(inputs) | ({HAND.name} if law.logic and "command" in law.logic.signals else set())
    commands = [(name, *place) for name, place in _COMMANDS.items() if name in seen]
    oldest, allowed = _oldest(record, period)
    release = re.match(r"\d+\.\d+\.\d+", record.package.version)
    return {
        "names": program.names,
        "law": law,
        "limits": limits,
        "about": program.about,
        "comment": block_comment(program.about, ROS2_NODE),
        "version": release[0] if release else "0.0.0",
        "verdict": record.verdict.upper(),
        "period": record.sample_time.exact,
        "nanoseconds": _whole(period * _NANO),
        "tolerance": repr(float(period * _TOLERANCE)),
        "given": inputs,
        "commands": commands,
        "told": seen,
        "values": {value.name: value for value in (HAND, POSITION, WANTED)},
        "left": [(k, monitor.KINDS[k]) for k in _LEFT.findall(monitor_header.decode())],
        "oldest": oldest,
        "allowed": allowed,
    }


def _oldest(record: ExportRecord, period: Fraction) -> tuple[int, str]:
    """Return how many samples old a torque may be, and who says so."""
    if record.delay is None:
        return 1, "the spec says nothing of its age: 1 sample is accepted"
    most = record.delay[1]
    who = "the proof allows" if record.unproved is None else "the spec allows"
    length = exact_text(period * 1000)
    return most, f"{who} {most} sample{'' if most == 1 else 's'} of {length} ms"


def _whole(nanoseconds: Fraction) -> int:
    """Return a period as a timer of ROS 2 takes it.

    Raises
    ------
    DesignError
        If it is no whole number.
    """
    if nanoseconds.denominator != 1:
        raise DesignError(
            "the period is no whole number of nanoseconds, which is what a timer of ROS 2 takes",
            remedy="choose another period, or export the C alone with --format c",
            at=("sampling", "period"),
        )
    return int(nanoseconds)
