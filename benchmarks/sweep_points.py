"""Points of a sweep: how many a second, what a second process gains, and what each costs beside.

The work of a point is `certify-switching` on the soft-tissue design with another stiffness. The
peer of the overhead is the same command, called in one process on files that somebody wrote. What
two processes gain is told by processor time, that of the busier one with all that it loads: where
others use the machine, clocks tell what these leave.
"""

from __future__ import annotations

import os
from collections import Counter
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time, process_time_ns
from typing import Any

from benchmarks.measure import Comparison, Finding, Size
from nrs_design.cli.printing import taking_json
from nrs_design.cli.sweep_point import Job, answer_point, program_of
from nrs_design.sweeps.grid import read_grid
from nrs_design.sweeps.spread import spread
from nrs_design.sweeps.store import Store

SPEC = Path(__file__).parents[1] / "specs/neuroboscope/soft-tissue.nrs.yaml"
COMMAND = "certify-switching"
# Of the time of a point, and of the processes.
SHARE, SPEED_UP = 0.5, 1.6


def run(size: Size) -> tuple[Comparison | Finding, ...]:
    """Measure one process, two, and points that are there."""
    count = size.pick(400, 100, 4)
    with TemporaryDirectory() as folder:
        bare = _bare(Path(folder), count)
        one = _job(Path(folder) / "one", count)
        answer_point(one, 0)
        (alone, one_busy), (again, _) = (_timed(one, 1) for _ in range(2))
        over = one_busy / bare - 1
        two, two_busy = _timed(_job(Path(folder) / "two", count), 2)
    return (
        Finding(
            f"{count} points of {COMMAND}, one process",
            f"{count / alone:.0f} points a second; overhead {over:.0%} of the command",
            f"overhead below {SHARE:.0%}",
            over < SHARE,
            alone,
        ),
        Comparison(
            f"{count} points, two processes",
            "one process",
            one_busy,
            two_busy,
            size.pick(SPEED_UP, None, None),
            f"processor time of the busier one; by the clock {alone:.1f} s and {two:.1f} s",
        ),
        Comparison(
            f"{count} points that are there, certificates checked again",
            "computing them",
            alone,
            again,
            None,
            f"{count / again:.0f} points a second",
        ),
    )


def _job(folder: Path, count: int) -> Job:
    grid = read_grid(SPEC, [f"environments.soft.stiffness=500..900/{count} N/m"])
    return Job(SPEC, grid, (COMMAND,), (), (COMMAND,), Store(folder))


def _timed(job: Job, jobs: int) -> tuple[float, float]:
    """Return the time of all points, and the processor time of the process that has most to do."""
    start, busy = perf_counter(), Counter[int]()
    found = dict(spread(partial(_measured, job), range(job.grid.count), jobs))
    seconds = perf_counter() - start
    assert len(found) == job.grid.count
    for process, used, error in found.values():
        assert error is None
        busy[process] += used
    return seconds, max(busy.values()) / 1e9


def _measured(job: Job, index: int) -> tuple[int, int, object]:
    """Answer a point: the process that did, the processor time in ns, and what is wrong."""
    start = process_time_ns()
    point = answer_point(job, index)
    return os.getpid(), process_time_ns() - start, point.error


def _bare(folder: Path, count: int) -> float:
    """Return the processor time of the same commands on written files, with nothing kept."""
    text = SPEC.read_text(encoding="utf-8")
    old = "{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}"
    assert old in text
    grid = _job(folder, count).grid
    files = []
    for at in range(count):
        files.append(folder / f"{at}.nrs.yaml")
        files[-1].write_text(text.replace(old, *grid.texts(at)), encoding="utf-8")
    program = program_of(COMMAND)
    _call(program, files[0], folder)
    start = process_time()
    for file in files:
        _call(program, file, folder)
    return process_time() - start


def _call(program: Any, file: Path, folder: Path) -> None:
    place = folder / f"{file.name}.cert.json"
    with taking_json() as documents:
        program.main(
            [COMMAND, str(file), "--out", str(place), "--json", "--quiet"], standalone_mode=False
        )
    assert documents
