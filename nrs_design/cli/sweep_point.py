"""One point of a sweep: a command, run in this process on a spec that says something else."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from nrs_design.cli import exit_codes
from nrs_design.cli.errors import error_summary
from nrs_design.errors import ClockError, NrsDesignError
from nrs_design.pipeline.sweep_grid import Grid
from nrs_design.spec.edits import saying_instead
from nrs_design.spec.load import read_axes
from nrs_design.spec.task_space import file_of

# Facts that differ from run to run, concern other specs, or give advice about the file.
LEFT_OUT = frozenset({"seconds", "certificate", "files", "path", "blocked_by", "next_steps"})


@dataclass(frozen=True, slots=True)
class Job:
    """What is done at every point."""

    spec: Path  # The file, or an axis of one
    grid: Grid
    command: tuple[
        str, ...
    ]  # Name of the command, split at spaces, such as ``("robot", "dynamics")``
    options: tuple[str, ...]  # Options as typed


@dataclass(frozen=True, slots=True)
class PointAnswer:
    """Answer of a command at one point."""

    values: tuple[str, ...]  # Values of the fields, in the order of the grid
    code: int  # Exit code of the command
    result: Mapping[str, Any] | None = None  # The JSON document, without times and places of files
    error: Mapping[str, Any] | None = None  # Error of a point without a result


def answer_point(job: Job, values: tuple[str, ...]) -> PointAnswer:
    """Return the answer of the command for values of the fields, whatever goes wrong with it."""
    with saying_instead(file_of(job.spec), job.grid.changes(values)):
        try:
            # An invalid spec is an error of its point, even for commands that report such errors.
            read_axes(job.spec)
            return PointAnswer(values, *_computed(job))
        except NrsDesignError as error:
            stopped = isinstance(error, ClockError)
            code = exit_codes.INCONCLUSIVE if stopped else exit_codes.USAGE
            return PointAnswer(values, code, error=error_summary(error))
        except Exception as error:
            # The parser of the command line has errors of its own.
            if hasattr(error, "format_message"):
                code, message = exit_codes.USAGE, error.format_message()
            else:
                code, message = exit_codes.INTERNAL, f"{type(error).__name__}: {error}"
                message = f"internal error (a defect of nrs-design): {message}"
            return PointAnswer(values, code, error=error_summary(NrsDesignError(message)))


def _computed(job: Job) -> tuple[int, dict[str, Any]]:
    """Run the command; return its exit code and its document."""
    import typer

    arguments = [*job.command, str(job.spec), *job.options, "--json", "--quiet"]
    program, code = program_of(job.command[0]), exit_codes.PROVED
    with redirect_stdout(io.StringIO()) as printed:
        try:
            with program.make_context("nrs-design", arguments) as context:
                program.invoke(context)
        except typer.Exit as end:
            code = end.exit_code
    return code, _lasting(json.loads(printed.getvalue()))


@cache
def program_of(command: str) -> Any:
    """Return the program with one command; to make it takes longer than many a command."""
    import typer

    from nrs_design.cli.app import make_app

    return typer.main.get_command(make_app([command]))


def _lasting(document: Any) -> Any:
    """Return a document without the facts in `LEFT_OUT`."""
    if isinstance(document, dict):
        return {key: _lasting(value) for key, value in document.items() if key not in LEFT_OUT}
    return list(map(_lasting, document)) if isinstance(document, list) else document
