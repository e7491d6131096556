"""``nrs-design sweep``: a command for many values of a spec."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.exit_codes import worst
from nrs_design.cli.options import SpecFile, refuse_both
from nrs_design.cli.printing import note, progress, wants_json
from nrs_design.errors import NrsDesignError

if TYPE_CHECKING:
    from nrs_design.cli.sweep_point import Job, PointAnswer

# Commands that answer about one spec, with --json, and write nothing elsewhere.
SWEPT = (
    "check",
    "optimize",
    "tune",
    "mode-logic",
    "certify-switching",
    "compare-methods",
    "simulate",
    "robot check",
    "robot kinematics",
    "robot dynamics",
    "robot balance",
    "robot correction",
)
# How many seconds are told as minutes, and minutes as hours.
_LONG = 120.0


@command("sweep", passes_on=True)
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
    store: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Folder of answers; default NAME.sweep beside the file of the spec."
        ),
    ] = None,
    no_store: Annotated[bool, typer.Option("--no-store", help="Keep no answers.")] = False,
    jobs: Annotated[int, typer.Option(min=1, help="How many processes.")] = 1,
    dask: Annotated[
        str | None,
        typer.Option(
            metavar="SCHEDULER",
            help="Let the workers of this dask.distributed scheduler compute, such as "
            "tcp://10.0.0.1:8786; they must share this folder and the store.",
        ),
    ] = None,
    shown: Annotated[
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

    Answers are kept: the same command goes on where it was cut off. What is kept as proved or
    refuted is used again only if its certificate is checked again, and holds.

    The exit code is that of the worst point: 4 before 2 before 1 before 3 before 0.

    Example: nrs-design sweep SPEC --set 'environments.soft.stiffness=500..2500/5 N/m'
    certify-switching

    Example: nrs-design sweep SPEC --set 'limits.bandwidth=1,2 Hz' --jobs 2 --show Bt optimize
    """
    from nrs_design.cli.sweep_answer import facts_of, table_text, view_of
    from nrs_design.output import SWEEP, check_place, write_output

    refuse_both(
        ("--store", "--no-store", store is not None and no_store),
        ("--jobs", "--dask", jobs > 1 and dask is not None),
        ("--no-store", "--dask", no_store and dask is not None),
    )
    if table is not None:
        check_place(table, SWEEP)
    with ExitStack() as stack:
        if no_store:
            folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        else:
            folder = store or _beside(spec)
        job = _job(spec, fields, words, folder)
        points = _points(job, jobs, dask)
        if table is not None:
            write_output(table, table_text(job, points), replaces=SWEEP)
            note(f"table written to {table}")
        facts = facts_of(job, points) if wants_json() else {}
        show = view_of(job, points, shown or ())
    return Answer(lambda: facts, show, worst({point.code for point in points}))


def _beside(spec: Path) -> Path:
    """Return the store of a spec that is named after its file."""
    from nrs_design.gating.find_specs import SUFFIXES
    from nrs_design.spec.task_space import file_of

    file = file_of(spec)
    ending = next((end for end in SUFFIXES if file.name.lower().endswith(end)), file.suffix)
    return file.with_name(f"{file.name[: len(file.name) - len(ending)]}.sweep")


def _job(spec: Path, fields: Sequence[str], words: Sequence[str], folder: Path) -> Job:
    """Return what is done at every point; refuse what could be done at none."""
    from nrs_design.cli.sweep_point import Job
    from nrs_design.sweeps.grid import read_grid
    from nrs_design.sweeps.store import Store

    name = _named(words)
    options = tuple(words[len(name) :])
    asked = _asked(name, spec, options)
    return Job(spec, read_grid(spec, fields), name, options, asked, Store(folder))


def _named(words: Sequence[str]) -> tuple[str, ...]:
    """Return the words of the command that is named first."""
    from nrs_design.spec.faults import did_you_mean

    for length in (1, 2):
        if " ".join(words[:length]) in SWEPT:
            return tuple(words[:length])
    begun = [name for name in SWEPT if name.startswith(words[0])][:1]
    raise NrsDesignError(
        f"{words[0]!r} is no command that is run at every point",
        remedy=did_you_mean(words[0], SWEPT, "there are", begun),
    )


def _asked(name: tuple[str, ...], spec: Path, options: tuple[str, ...]) -> tuple[str, ...]:
    """Return a command and its options however they were typed, and refuse those it has not."""
    from nrs_design.cli.sweep_point import program_of

    found, given = program_of(name[0]), [str(spec), *options]
    for word in name:
        found = getattr(found, "commands", {}).get(word, found)
    context = found.make_context(" ".join(name), given)
    said = []
    for parameter, value in sorted(context.params.items()):
        if context.get_parameter_source(parameter).name == "DEFAULT" or parameter == "quiet":
            continue
        values = value if isinstance(value, list | tuple) else (value,)
        if parameter in ("spec", "specs"):
            if len(values) > 1:
                raise NrsDesignError(
                    "the command of a sweep names no spec of its own",
                    remedy="leave it out behind COMMAND",
                )
        elif any(isinstance(part, Path) for part in values):
            raise NrsDesignError(
                f"{' '.join(name)} takes no file at the points of a sweep",
                remedy="leave that option out: a point depends on its spec and on options alone, "
                "and its answer is in the store",
            )
        else:
            said.append(f"{parameter}={[*map(str, values)]}")
    return (*name, *said)


def _points(job: Job, jobs: int, dask: str | None) -> list[PointAnswer]:
    """Compute what is not there, and return all points in the order of the grid."""
    from nrs_design.cli.sweep_point import answer_point
    from nrs_design.sweeps.spread import map_in_processes, spread_by_dask

    work, every = partial(answer_point, job), range(job.grid.count)
    coming = (
        map_in_processes(work, every, jobs) if dask is None else spread_by_dask(work, every, dask)
    )
    found: dict[int, PointAnswer] = {}
    computed, start = 0, perf_counter()
    with progress(f"{job.grid.count} points") as step:
        for index, point in coming:
            found[index] = point
            computed += not point.reused
            # What was there already says nothing about how long the rest takes.
            each = (perf_counter() - start) / max(computed, 1)
            step(f"{len(found)} done, {_duration(each * (len(every) - len(found)))} left")
    took = _duration(perf_counter() - start)
    note(f"{computed} computed, {len(found) - computed} were there: {took}")
    return [found[index] for index in every]


def _duration(seconds: float) -> str:
    """Write a time as people read it."""
    if seconds < _LONG:
        return f"{seconds:.0f} s"
    minutes = seconds / 60
    return f"{minutes:.0f} min" if minutes < _LONG else f"{minutes / 60:.1f} h"
