"""What a sweep has found: a table for people, a table as CSV, and one JSON document."""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from nrs_design.cli import exit_codes
from nrs_design.cli.printing import say
from nrs_design.cli.tables import print_table
from nrs_design.errors import NrsDesignError
from nrs_design.sweeps.table import Columns, Row, cell_text, chosen, fact_columns, flat, short_names

if TYPE_CHECKING:
    from nrs_design.cli.sweep_point import Job, PointAnswer

# What a terminal shows of rows, columns and messages; files hold them all.
MOST_ROWS, MOST_COLUMNS, MOST_MESSAGES, MOST_NAMED = 200, 6, 5, 12
# What an answer without a verdict is called, by its exit code.
WORDS: Mapping[int, str] = {
    exit_codes.PROVED: "met",
    exit_codes.REFUTED: "missed",
    exit_codes.USAGE: "wrong",
    exit_codes.INCONCLUSIVE: "inconclusive",
    exit_codes.INTERNAL: "defect",
}


def facts_of(job: Job, points: Sequence[PointAnswer]) -> dict[str, Any]:
    """Return the content of the JSON document: the same for any number of processes."""
    from nrs_design.spec.load import read_axes

    axes = read_axes(job.spec)
    return {
        "spec": str(job.spec),
        "spec_sha256": [axis.sha256 for axis in axes],
        "command": [*job.command, *job.options],
        "fields": [field.path for field in job.grid.fields],
        "points": [
            {
                "values": list(point.texts),
                "exit_code": point.code,
                "result": result,
                "error": point.error,
            }
            for point, result in _results(job, points)
        ],
    }


def table_text(job: Job, points: Sequence[PointAnswer]) -> str:
    """Return all facts as CSV: a row for each point, a column for each number or word."""
    columns = _columns(job, points)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    fields = job.grid.fields
    heads = [f"{field.path} [{field.unit}]" if field.unit else field.path for field in fields]
    writer.writerow(["point", "exit_code", "message", *heads, *columns.every])
    for index, (point, result) in enumerate(_results(job, points)):
        row = _row(result)
        facts = [row.get(name) for name in columns.every]
        writer.writerow([index, point.code, _message(point), *_values(job, point), *facts])
    return text.getvalue()


def view_of(job: Job, points: Sequence[PointAnswer], wanted: Sequence[str]) -> Callable[[], None]:
    """Return what prints what people see: what was set, how it ended, and some facts.

    Without names of facts, the first ones that differ from point to point.
    """
    every = _columns(job, points)
    # How it ended has a column of its own.
    telling = [name for name in every.telling if name != "verdict"]
    names = chosen(every, wanted) if wanted else telling[:MOST_COLUMNS]
    rows, ended = list[tuple[str, ...]](), Counter[str]()
    for point, result in _results(job, points):
        row = _row(result)
        word = str(row.get("verdict", WORDS[point.code]))
        ended[word] += 1
        if len(rows) < MOST_ROWS:
            facts = (cell_text(row.get(name)) for name in names)
            rows.append((*_values(job, point), word, *facts))
    counted = ", ".join(f"{count} {word}" for word, count in ended.items())
    lines = [f"{len(points)} points: {counted}"]
    if len(points) > MOST_ROWS:
        lines.append(f"{len(points) - MOST_ROWS} more rows: --csv FILE holds them all")
    if not wanted and len(telling) > MOST_COLUMNS:
        more = ", ".join(short_names(telling)[MOST_COLUMNS:][:MOST_NAMED])
        lines.append(f"more facts differ (--show NAME, or --csv FILE for all): {more}")
    lines += _messages(job, points)
    fields = job.grid.fields
    heads = (f"{field.path}\n{field.unit}" if field.unit else field.path for field in fields)
    columns = (*heads, "answer", *short_names(names))

    def show() -> None:
        say(f"{job.spec}: {' '.join((*job.command, *job.options))}")
        print_table("", columns, rows)
        for line in lines:
            say(line)

    return show


def _results(
    job: Job, points: Sequence[PointAnswer]
) -> Iterator[tuple[PointAnswer, Mapping[str, Any] | None]]:
    """Yield each point with its answer, read from the store: many do not fit into memory at once.

    A `NrsDesignError` if an answer is no longer what was found.
    """
    for point in points:
        kept = job.store.read(point.key) if point.key else None
        if point.key and (kept is None or kept.id(point.key) != point.id):
            raise NrsDesignError(
                "an answer was changed while it was read",
                path=job.store.entry(point.key),
                remedy="run the same command again: it is computed again",
            )
        yield point, None if kept is None else kept.result


def _columns(job: Job, points: Sequence[PointAnswer]) -> Columns:
    return fact_columns(_row(result) for _, result in _results(job, points) if result is not None)


def _row(result: Mapping[str, Any] | None) -> Row:
    return {} if result is None else dict(flat(result))


def _values(job: Job, point: PointAnswer) -> list[str]:
    """Return the values of a point, without the unit where that stands above them."""
    return [
        _number(text.removesuffix(f" {field.unit}")) if field.unit else text
        for field, text in zip(job.grid.fields, point.texts, strict=True)
    ]


def _number(text: str) -> str:
    """Write a ratio as a decimal."""
    from nrs_design.spec import parse_exact

    return f"{float(parse_exact(text)):.10g}" if "/" in text else text


def _message(point: PointAnswer) -> str:
    faults = () if point.error is None else point.error["faults"]
    return "; ".join(fault["message"] for fault in faults)


def _messages(job: Job, points: Sequence[PointAnswer]) -> Iterator[str]:
    """Yield what is wrong, with the values of the first point of which it is said."""
    paths = [field.path for field in job.grid.fields]
    said: dict[str, list[PointAnswer]] = {}
    for point in points:
        if point.error is not None:
            said.setdefault(_message(point), []).append(point)
    for message, about in list(said.items())[:MOST_MESSAGES]:
        where = ", ".join(f"{p}={text}" for p, text in zip(paths, about[0].texts, strict=True))
        more = f" (and {len(about) - 1} more)" if len(about) > 1 else ""
        yield f"{WORDS[about[0].code]}: {where}{more}: {message}"
    if len(said) > MOST_MESSAGES:
        yield f"{len(said) - MOST_MESSAGES} more messages: --csv FILE holds them all"
