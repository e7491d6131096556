"""The whole table. A new capability adds its module of rows to `TOPICS`, and nothing else."""

from __future__ import annotations

from nrs_design.progress import Progress, silent
from nrs_design.reproduction import (
    actuator,
    balance,
    correction,
    experiments,
    force_loop,
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
from nrs_design.reproduction.comparison import PrintVerdict, ReproducedValue

# In the order of the thesis.
TOPICS = (
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


def reproduce(progress: Progress = silent) -> tuple[ReproducedValue, ...]:
    """Recompute every number of every topic.

    Parameters
    ----------
    progress : callable
        Told the name of each topic as it begins.
    """
    table: list[ReproducedValue] = []
    for topic in TOPICS:
        progress(topic.__name__.rpartition(".")[2].replace("_", " "))
        table.extend(topic.rows())
    return tuple(table)


def count_verdicts(table: tuple[ReproducedValue, ...]) -> dict[str, int]:
    """Return how many rows have each verdict that occurs."""
    found = [row.verdict for row in table]
    return {str(verdict): found.count(verdict) for verdict in PrintVerdict if verdict in found}
