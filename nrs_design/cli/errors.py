"""Errors in the form of compilers: with the line of the file and a caret."""

from __future__ import annotations

import shutil
import sys
from dataclasses import asdict
from itertools import islice
from pathlib import Path
from typing import Any

from nrs_design.cli.printing import painted, wrapped
from nrs_design.errors import Fault, NrsDesignError
from nrs_design.printable import printable

# A user corrects no more at once.
MAX_SHOWN = 20
# In JSON, for editors.
MAX_LISTED = 100
# Columns of a shown line of the file; fewer on a narrow terminal.
WIDEST_LINE = 100
# A larger file is data, not text with lines, in bytes.
LARGEST_FILE = 16 * 1024 * 1024


def print_error(error: NrsDesignError) -> None:
    """Write every fault to stderr, each with its place and its remedy."""
    faults = error.faults
    blocks = [
        _block(error.rule, fault, error.path) if fault.line else _headed(error.rule, str(error))
        for fault in faults[:MAX_SHOWN]
    ]
    if len(faults) > 1:
        omission = f" and {len(faults) - MAX_SHOWN} more" if len(faults) > MAX_SHOWN else ""
        location = f" in {printable(error.path)}" if error.path else ""
        blocks = [f"{block}\n" for block in blocks] + [f"{len(blocks)} faults{omission}{location}"]
    sys.stderr.write("\n".join(blocks) + "\n")


def error_summary(error: NrsDesignError) -> dict[str, Any]:
    """Return the faults of an error in file order, and their number, for ``--json``."""
    return {
        "rule": error.rule,
        "count": len(error.faults),
        "path": None if error.path is None else str(error.path),
        "faults": [asdict(fault) for fault in error.faults[:MAX_LISTED]],
    }


def _headed(rule: str, message: str) -> str:
    head = f"error[{rule}]"
    text = wrapped(f"{head}: {printable(message)}", sys.stderr)
    return painted(head, "red", sys.stderr) + text.removeprefix(head)


def _block(rule: str, fault: Fault, path: Path | None) -> str:
    gutter = " " * len(str(fault.line))
    arrow, bar, equals = (painted(mark, "blue", sys.stderr) for mark in ("-->", "|", "="))
    place = ":".join(str(part) for part in (path or "spec", fault.line, fault.column) if part)
    lines = [_headed(rule, fault.message), f"{gutter}{arrow} {printable(place)}"]
    source = None if path is None else _source(path, fault.line or 1)
    if source is not None:
        text, before = excerpt(source, fault.column or 1, max(_width() - len(gutter) - 3, 20))
        number = painted(str(fault.line), "blue", sys.stderr)
        lines += [f"{gutter} {bar}", f"{number} {bar} {text}"]
        if fault.column:
            lines.append(f"{gutter} {bar} {' ' * before}{painted('^', 'red', sys.stderr)}")
    if fault.remedy:
        helped = wrapped(f"{gutter} = help: {printable(fault.remedy)}", sys.stderr, hanging=8)
        lines.append(helped.replace("=", equals, 1))
    return "\n".join(lines)


def _width() -> int:
    terminal = shutil.get_terminal_size().columns if sys.stderr.isatty() else WIDEST_LINE
    return min(terminal, WIDEST_LINE)


def _source(path: Path, line: int) -> str | None:
    """Return a line of a file, if it still can be read."""
    from nrs_design.spec.task_space import file_of

    try:
        path = file_of(path)
        if not path.is_file() or path.stat().st_size > LARGEST_FILE:
            return None
        with path.open("rb") as raw:
            if b"\0" in raw.read(1024):
                return None
        with path.open(encoding="utf-8-sig", errors="replace") as file:
            found = next(islice(file, line - 1, None), None)
    except (OSError, ValueError):
        return None
    return None if found is None else found.rstrip("\n")


def excerpt(line: str, column: int, width: int) -> tuple[str, int]:
    """Cut a line to what is around a column, with escapes for what cannot be shown.

    The column is counted from 1. Returns the text, and how many columns of a terminal stand before
    it.
    """
    from rich.cells import cell_len, set_cell_size

    before = printable(line[: column - 1][-2 * width :])
    after = printable(line[column - 1 :][: 2 * width])
    if cell_len(before + after) > width:
        while cell_len(before) > width // 2:
            before = before[1:]
        after = set_cell_size(after, width - cell_len(before)).rstrip()
    return before + after, cell_len(before)
