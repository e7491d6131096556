"""The record of a build: compiler, flags, hashes, what passed, and what nobody looked at.

It has no date, and no path but those of the user's lines: the same build is the same text, so that
a change of compiler, flags or binary is a change of the file.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from nrs_design import __version__
from nrs_design.certificates.certificate import Certificate
from nrs_design.exporters.binary import Binary, Toolchain
from nrs_design.exporters.deployed import BINARY_RECORD, DeployedFiles
from nrs_design.output import BINARY, write_output

SCHEMA = "nrs-design/binary/1"


def binary_document(
    certificate: Certificate, comparison: DeployedFiles, tools: Toolchain, binary: Binary
) -> dict[str, Any]:
    """Return what is known of a binary that passed.

    Parameters
    ----------
    certificate : Certificate
        Of which law the binary is.
    comparison : DeployedFiles
        Without a difference.
    tools : Toolchain
        Commands of the user.
    binary : Binary
        Without a fault.
    """
    return {
        "schema": SCHEMA,
        "package": __version__,
        "spec": {"name": certificate.spec_name, "sha256": certificate.spec_sha256},
        "certificate": certificate.id,
        "compiler": {"version": binary.version, "target": binary.target},
        "compile": list(tools.compile),
        "link": list(binary.link),
        "run": list(binary.run),
        "result": binary.result,
        "compared": binary.sources,
        "compiled": binary.objects,
        "not_compared": [*_left_out(comparison, binary)],
    }


def write_record(folder: Path, document: dict[str, Any]) -> tuple[Path, tuple[str, ...]]:
    """Write a record beside what was built; return its place, and what differs from the one before.

    Parameters
    ----------
    folder : Path
        Of the deployed files.
    document : dict
        As `binary_document` returns it.

    Raises
    ------
    OutputError
        If something else stands in its place, or the folder cannot be written to.
    """
    path = folder / f"{document['spec']['name']}{BINARY_RECORD}"
    before = _before(path)
    write_output(path, json.dumps(document, indent=2) + "\n", replaces=BINARY)
    changed = (key for key in document if before and before.get(key) != document[key])
    return path, tuple(changed)


def _before(path: Path) -> dict[str, Any]:
    """Return the record that is replaced; nothing if there is none that can be read."""
    try:
        found = json.loads(path.read_bytes()) if path.is_file() else {}
    except (OSError, ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def _left_out(comparison: DeployedFiles, binary: Binary) -> Iterator[str]:
    yield "comments in the files that were compared"
    yield from (f"{file.name}: no export" for file in comparison.others)
    yield (
        "the program of the robot: it has to link the object of the law, by its SHA-256 (with "
        "-flto it is other code)"
    )
    if any(file.name.endswith("_monitor.c") for file in comparison.compared):
        yield "the monitor was compiled, and not run"
    yield "what the compiler takes from its environment, such as CPATH"
    yield "start, clock, interrupts, rounding mode and subnormal numbers as the robot sets them"
    yield "input and output: sensors, their signs, drives"
    if binary.emulated:
        yield "silicon: an emulator ran it"
