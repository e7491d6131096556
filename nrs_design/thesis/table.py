"""Table of all topics of `rows.yaml`, and its page."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from nrs_design import __version__
from nrs_design.progress import Progress, silent
from nrs_design.thesis import formulas, loops, materials, robot, runs, switching
from nrs_design.thesis.comparison import (
    Erratum,
    PrintVerdict,
    ReproducedValue,
    Result,
    compare_topic,
    errata,
    read_data,
)

CONVERTED = (
    "The dissertation's text was converted by machine: single characters that differ may be slips "
    "of the conversion and not of the print."
)


# Function that computes the results of each topic.
TOPICS: Mapping[str, Callable[[], Iterable[Result]]] = {
    "formulas": formulas.formulas,
    "tissue": materials.tissue,
    "robot_kinematics": robot.robot_kinematics,
    "robot_dynamics": robot.robot_dynamics,
    "correction": robot.correction,
    "actuator": loops.actuator,
    "root_locus": loops.root_locus,
    "tracking": robot.tracking,
    "balance": robot.passive_balance,
    "specimens": materials.specimens,
    "impedance": loops.impedance,
    "modes": switching.modes,
    "force_loop": loops.force_loop,
    "switching": switching.switching,
    "gradient": switching.gradient,
    "experiments": loops.experiments,
    "runs": runs.simulated_runs,
    "hands_on": loops.passivity,
    "hand_runs": runs.hand_runs,
}


def reproduce(progress: Progress = silent) -> tuple[ReproducedValue, ...]:
    """Recompute every number of every topic."""
    table: list[ReproducedValue] = []
    for topic in read_data("rows.yaml"):
        progress(topic.replace("_", " "))
        table.extend(topic_rows(topic))
    return tuple(table)


def topic_rows(topic: str) -> tuple[ReproducedValue, ...]:
    """Return the rows of a topic of `rows.yaml`, compared with what is computed."""
    return compare_topic(topic, TOPICS[topic]())


def count_verdicts(table: Sequence[ReproducedValue]) -> dict[str, int]:
    """Return how many rows have each verdict that occurs."""
    found = [row.verdict for row in table]
    return {str(verdict): found.count(verdict) for verdict in PrintVerdict if verdict in found}


def printed_errors(
    table: Sequence[ReproducedValue],
) -> tuple[tuple[Erratum, tuple[ReproducedValue, ...]], ...]:
    """Return each error of the print once, with the rows that are printed differently for it."""
    wrong = [row for row in table if row.verdict is PrintVerdict.PRINTED_DIFFERENTLY]
    found = ((one, tuple(row for row in wrong if one.id in row.errata)) for one in errata())
    return tuple((one, error_rows) for one, error_rows in found if error_rows)


def counts_line(table: Sequence[ReproducedValue]) -> str:
    """Write the counts of rows, and of the errors behind those that are printed differently."""
    wrong = str(PrintVerdict.PRINTED_DIFFERENTLY)
    parts = (
        f"{count} {verdict}"
        + (f" (errors of the print: {len(printed_errors(table))})" if verdict == wrong else "")
        for verdict, count in count_verdicts(table).items()
    )
    return f"{len(table)} rows: {', '.join(parts)}."


def render_page(table: tuple[ReproducedValue, ...]) -> str:
    """Return the page; the same rows give the same bytes."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("nrs_design.thesis"),
        autoescape=True,
        undefined=StrictUndefined,
        keep_trailing_newline=True,
    )
    environment.globals["within"] = format_within
    template = environment.get_template("reproduce.html.j2")
    return template.render(
        rows=table,
        counts=count_verdicts(table),
        errors=printed_errors(table),
        summary=counts_line(table),
        converted=CONVERTED,
        version=__version__,
    )


def format_within(deviation: float | None, limit: str) -> str:
    """Write a deviation with two digits and the limit that it is held to; none at all as nothing.

    It is relative, or absolute where what it is from is zero.
    """
    if deviation is None:
        return ""
    return f"{f'{deviation:.1e}' if deviation else '0'} ({limit})"
