"""Designs and robots for other programs: the table of formats, one module each.

A module renders all files of its format and touches no disk: `render(export)` returns their
contents by what follows the name of the spec. Modules are imported when they are asked for.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from nrs_design.output import (
    C_HEADER,
    C_MONITOR,
    C_MONITOR_HEADER,
    C_SOURCE,
    C_TEST,
    C_TEST_HEADER,
    EXPORT,
    FMU,
    MAT,
    VECTOR_TABLE,
    VECTOR_TEST,
    VECTORS,
)


@dataclass(frozen=True, slots=True)
class Format:
    """What a format is for, and which files it has."""

    module: str  # Of this package; it has ``render``
    purpose: str  # What the files are for, in a few words
    needs: str  # What there must be before they are written
    # What follows the name of the spec in the name of each file, and how that file begins: one that
    # begins otherwise is another's, and is not overwritten.
    files: Mapping[str, bytes]
    # Whether a processor runs it, so that the proof must be about the sampled loop.
    executable: bool = False
    # Whether the module also has ``remarks``, which says what rendered files lack.
    remarks: bool = False


DESIGN = "a proof of the design"
SAMPLED = "a proof of the sampled loop, or --unproved"
# Of specs of kind interaction-design.
FORMATS: Mapping[str, Format] = MappingProxyType(
    {
        "json": Format(
            "json_record",
            "gains with what is proved of them; the record that every format holds",
            DESIGN,
            {".export.json": EXPORT},
        ),
        "c": Format(
            "c",
            "C99 for a processor: init and step in single precision, no heap, no libm",
            SAMPLED,
            {".h": C_HEADER, ".c": C_SOURCE},
            executable=True,
        ),
        "vectors": Format(
            "vectors",
            "inputs and exact outputs that any implementation of the law must give, with tests",
            SAMPLED,
            {
                ".vectors.json": VECTORS,
                ".vectors.csv": VECTOR_TABLE,
                "_test.h": C_TEST_HEADER,
                "_test.c": C_TEST,
                "_test.py": VECTOR_TEST,
            },
            executable=True,
        ),
        "monitor": Format(
            "monitor",
            "C99 that tells when a running loop first leaves its proof; takes the header of c",
            SAMPLED,
            {"_monitor.h": C_MONITOR_HEADER, "_monitor.c": C_MONITOR},
            executable=True,
        ),
        "fmu": Format(
            "fmu",
            "the law for co-simulation by FMI 2.0, with sources, and compiled where cc is",
            SAMPLED,
            {".fmu": FMU},
            executable=True,
            remarks=True,
        ),
        "mat": Format(
            "matlab",
            "plant, controllers, loops, modes and certificate for MATLAB, GNU Octave and SciPy",
            DESIGN,
            {".mat": MAT},
        ),
    }
)
# Of specs of kind robot, by `nrs-design robot export`.
ROBOT_FORMATS: Mapping[str, Format] = MappingProxyType(
    {
        "c": Format(
            "robot_c",
            "motion control and dynamics of the robot in C99, in single precision",
            "a robot spec (robot export), and --unproved: nothing is proved of them",
            {".h": C_HEADER, ".c": C_SOURCE},
            executable=True,
        ),
        "vectors": Format(
            "robot_vectors",
            "inputs and exact outputs that any implementation of these laws must give",
            "a robot spec (robot export), and --unproved: nothing is proved of them",
            {".robot-vectors.json": b'{\n "schema": "nrs-design/robot-vectors/'},
            executable=True,
        ),
        "mjcf": Format(
            "mjcf",
            "the robot with its closed loops for MuJoCo",
            "a robot spec (robot export)",
            {".mjcf.xml": b"<!-- nrs-design mjcf of "},
        ),
        "urdf": Format(
            "urdf",
            "the spanning tree of the robot, without its loops",
            "a robot spec (robot export)",
            {".urdf": b'<?xml version="1.0"?>\n<!-- nrs-design urdf of '},
        ),
    }
)
