"""``nrs-design sweep``: a command for many values of a spec."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.cli.tables import print_table
from nrs_design.errors import NrsDesignError

if TYPE_CHECKING:
    from nrs_design.cli.sweep_point import Job, PointAnswer
    from nrs_design.pipeline.sweep_table import Row

# Commands that answer about one spec, with --json, and write nothing elsewhere.
SWEPT = (
    "check",
    "optimize",
    "tune",
    "mode-logic",
    "certify-switching",
    "simulate",
    "robot check",
    "robot kinematics",
    "robot dynamics",
    "robot balance",
    "robot correction",
)
# Largest numbers of rows, columns and messages on a terminal; --csv and --json hold all.
MOST_ROWS, MOST_COLUMNS, MOST_MESSAGES = 200, 6, 5
# Words for answers without a verdict, by exit code.
WORDS = {
    exit_codes.PROVED: "met",
    exit_codes.REFUTED: "missed",
    exit_codes.USAGE: "wrong",
    exit_codes.INCONCLUSIVE: "inconclusive",
    exit_codes.INTERNAL: "defect",
}


@command("sweep", forwards_options=True)
def sweep(
    spec: SpecFile,
    words: Annotated[
        list[str],
        typer.Argument(
            metavar="COMMAND...",
            help="The command with its options, but without SPEC; what has an option of the same "
            "name as this command stands behind --.",
        ),
    ],
    fields: Annotated[
        list[str],
        typer.Option(
            "--set",
            metavar="PATH=VALUES",
            help="A field of the spec and its values: a list '1,2,5 N*m/rad', or a range with a "
            "count '1..250/16 N*m/rad'. Up to three times: every combination is a point.",
        ),
    ],
    jobs: Annotated[int, typer.Option(min=1, help="How many processes.")] = 1,
    fact_names: Annotated[
        list[str] | None,
        typer.Option(
            "--show",
            metavar="FACT",
            help="Show this fact of every answer, such as Bt or decay_rate; may be repeated. "
            "Default: the first ones that differ.",
        ),
    ] = None,
    table: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Write all facts as a table.")
    ] = None,
) -> Answer:
    """Run a command for every combination of values of one to three fields of a spec.

    The exit code is that of the worst point: 4 before 2 before 1 before 3 before 0.

    Example: nrs-design sweep SPEC --set 'environments.soft.stiffness=500..2500/5 N/m'
    certify-switching

    Example: nrs-design sweep SPEC --set 'limits.bandwidth=1,2 Hz' --jobs 2 --show Bt optimize
    """
    from nrs_design.cli.sweep_point import Job
    from nrs_design.output import SWEEP, check_place, write_output
    from nrs_design.pipeline.sweep_grid import read_grid
    from nrs_design.pipeline.sweep_table import choose_facts, flat

    if table is not None:
        check_place(table, SWEEP)
    name = _command_name(words)
    job = Job(spec, read_grid(spec, fields), name, tuple(words[len(name) :]))
    _check_options(job)
    points = _points(job, jobs)
    found = _Swept(job, points, [dict(flat(point.result or {})) for point in points])
    names = choose_facts(found.rows, fact_names) if fact_names else None
    if table is not None:
        write_output(table, found.table(), replaces=SWEEP)
        note(f"table written to {table}")
    code = exit_codes.worst({point.code for point in found.points})
    return Answer(found.facts, lambda: found.show(names), code)


def _command_name(words: Sequence[str]) -> tuple[str, ...]:
    """Return the words of the command that is named first."""
    for length in (1, 2):
        if " ".join(words[:length]) in SWEPT:
            return tuple(words[:length])
    raise NrsDesignError(
        f"{words[0]!r} is no command that is run at every point",
        remedy=f"there are {', '.join(SWEPT)}",
    )


def _check_options(job: Job) -> None:
    """Refuse options that the command has not, and files."""
    from nrs_design.cli.sweep_point import program_of

    found = program_of(job.command[0])
    for word in job.command:
        found = getattr(found, "commands", {}).get(word, found)
    name = " ".join(job.command)
    for value in found.make_context(name, [str(job.spec), *job.options]).params.values():
        files = [one for one in (value if isinstance(value, list) else [value])
                 if isinstance(one, Path)]  # fmt: skip
        if files not in ([], [job.spec]):
            raise NrsDesignError(
                f"{name} takes no file at the points of a sweep, and no spec of its own",
                remedy="leave it out: a point depends on its spec and on options alone",
            )


def _points(job: Job, jobs: int) -> list[PointAnswer]:
    """Return the answers of all points, in the order of the grid."""
    from nrs_design.cli.sweep_point import answer_point
    from nrs_design.pipeline.processes import map_in_processes

    points = job.grid.points
    found: dict[int, PointAnswer] = {}
    with progress(f"{len(points)} points") as step:
        for index, answer in map_in_processes(partial(answer_point, job), points, jobs):
            found[index] = answer
            step(f"{len(found)} done")
    return [found[index] for index in range(len(points))]


@dataclass(frozen=True, slots=True)
class _Swept:
    """Answers of a sweep; the number of processes does not change them."""

    job: Job
    points: Sequence[PointAnswer]
    rows: Sequence[Row]  # Facts of each point

    def facts(self) -> dict[str, Any]:
        """Return the content of the JSON document."""
        from nrs_design.spec.load import read_axes

        return {
            "spec": str(self.job.spec),
            "spec_sha256": [axis.sha256 for axis in read_axes(self.job.spec)],
            "command": [*self.job.command, *self.job.options],
            "fields": [field.path for field in self.job.grid.fields],
            "points": [
                {
                    "values": list(point.values),
                    "exit_code": point.code,
                    "result": point.result,
                    "error": point.error,
                }
                for point in self.points
            ],
        }

    def table(self) -> str:
        """Return all facts as CSV: a row for each point, a column for each number or word."""
        from nrs_design.pipeline.sweep_table import facts_in

        text, names = io.StringIO(), facts_in(self.rows)
        writer = csv.writer(text, lineterminator="\n")
        heads = [f"{f.path} [{f.unit}]" if f.unit else f.path for f in self.job.grid.fields]
        writer.writerow(["point", "exit_code", "message", *heads, *names])
        for at, (point, row) in enumerate(zip(self.points, self.rows, strict=True)):
            facts = [row.get(name) for name in names]
            writer.writerow([at, point.code, _message(point), *self._values(point), *facts])
        return text.getvalue()

    def show(self, fact_names: list[str] | None) -> None:
        """Print what was set, how it ended, and some facts; by default those that differ."""
        from nrs_design.pipeline.sweep_table import cell_text, telling

        # The column `answer` shows the verdict.
        names = fact_names or [name for name in telling(self.rows) if name != "verdict"]
        names, omitted_names = (
            (names, []) if fact_names else (names[:MOST_COLUMNS], names[MOST_COLUMNS:])
        )
        columns = [f"{f.path}\n{f.unit}" if f.unit else f.path for f in self.job.grid.fields]
        ends = [
            str(row.get("verdict", WORDS[point.code]))
            for point, row in zip(self.points, self.rows, strict=True)
        ]
        say(f"{self.job.spec}: {' '.join((*self.job.command, *self.job.options))}")
        print_table(
            "",
            [*columns, "answer", *names],
            [
                (*self._values(point), end, *(cell_text(row.get(name)) for name in names))
                for point, end, row in zip(self.points[:MOST_ROWS], ends, self.rows, strict=False)
            ],
        )
        counts = ", ".join(f"{count} {word}" for word, count in Counter(ends).items())
        say(f"{len(self.points)} points: {counts}")
        if omitted_names or len(self.points) > MOST_ROWS:
            omission = ", ".join(omitted_names) or "-"
            say(f"--csv FILE holds all rows and facts; more that differ: {omission}")
        for line in islice(self._messages(), MOST_MESSAGES):
            say(line)

    def _values(self, point: PointAnswer) -> list[str]:
        """Return the values of a point, without the unit where that stands above them."""
        return [
            text.removesuffix(f" {field.unit}")
            for field, text in zip(self.job.grid.fields, point.values, strict=True)
        ]

    def _messages(self) -> Iterator[str]:
        """Yield each error message once, with the values of its first point."""
        paths = [field.path for field in self.job.grid.fields]
        messages = {_message(point): point for point in reversed(self.points) if point.error}
        for message, point in reversed(messages.items()):
            setting = ", ".join(f"{p}={text}" for p, text in zip(paths, point.values, strict=True))
            yield f"{WORDS[point.code]}: {setting}: {message}"


def _message(point: PointAnswer) -> str:
    faults = () if point.error is None else point.error["faults"]
    return "; ".join(fault["message"] for fault in faults)
