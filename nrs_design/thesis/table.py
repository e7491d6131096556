"""The whole table. A new capability adds its module of rows to `TOPICS`, and nothing else."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType

from nrs_design.progress import Progress, silent
from nrs_design.thesis import (
    actuator,
    balance,
    correction,
    experiments,
    force_loop,
    formulas,
    gradient,
    hand_runs,
    hands_on,
    impedance,
    modes,
    robot_dynamics,
    robot_kinematics,
    root_locus,
    runs,
    specimens,
    switching,
    tissue,
    tracking,
)
from nrs_design.thesis.comparison import PrintVerdict, ReproducedValue, compare_topic
from nrs_design.thesis.errata import Erratum, errata

# In the order of the thesis, but for the formulas.
TOPICS = (
    formulas,
    tissue,
    robot_kinematics,
    robot_dynamics,
    correction,
    actuator,
    root_locus,
    tracking,
    balance,
    specimens,
    impedance,
    modes,
    force_loop,
    switching,
    gradient,
    experiments,
    runs,
    hands_on,
    hand_runs,
)

CONVERTED = (
    "The dissertation's text was converted by machine: single characters that differ may be slips "
    "of the conversion and not of the print."
)


def reproduce(progress: Progress = silent) -> tuple[ReproducedValue, ...]:
    """Recompute every number of every topic."""
    table: list[ReproducedValue] = []
    for topic in TOPICS:
        progress(topic.__name__.rpartition(".")[2].replace("_", " "))
        table.extend(topic_rows(topic))
    return tuple(table)


def topic_rows(topic: ModuleType) -> tuple[ReproducedValue, ...]:
    """Return the rows of a topic: those of `rows.yaml`, and what was measured on the robot."""
    rows = compare_topic(topic.__name__.rpartition(".")[2], topic.results())
    return (*rows, *tracking.measured()) if topic is tracking else rows


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
    return tuple((one, touched) for one, touched in found if touched)


def counts_line(table: Sequence[ReproducedValue]) -> str:
    """Write the counts of rows, and of the errors behind those that are printed differently."""
    wrong = str(PrintVerdict.PRINTED_DIFFERENTLY)
    parts = (
        f"{count} {verdict}"
        + (f" (errors of the print: {len(printed_errors(table))})" if verdict == wrong else "")
        for verdict, count in count_verdicts(table).items()
    )
    return f"{len(table)} rows: {', '.join(parts)}."
