"""Measuring: medians of repeats, whole child processes, and the machine that it is done on."""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from statistics import median
from time import perf_counter, process_time
from typing import TypeVar

from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certify import Certification, Limits, certify
from nrs_design.search.method import Method

T = TypeVar("T")
LAUNCHER = Path(__file__).with_name("launcher.py")
LIBRARIES = ("nrs-design", "numpy", "scipy", "clarabel", "cvxpy", "sympy")


@dataclass(frozen=True)
class Comparison:
    """A ratio of two times, one row of the results."""

    work: str
    peer: str
    peer_seconds: float  # Median
    our_seconds: float  # Median
    target: float | None  # Least ratio peer/ours; None if the ratio is only reported
    note: str = ""

    @property
    def ratio(self) -> float:
        """How many times as long the peer takes."""
        return self.peer_seconds / self.our_seconds

    @property
    def met(self) -> bool | None:
        """Whether the target is met; None if there is none."""
        return None if self.target is None else self.ratio >= self.target


@dataclass(frozen=True)
class Finding:
    """A row of the results that is not a ratio of two times."""

    work: str
    result: str  # With units
    aim: str
    met: bool
    seconds: float


@dataclass(frozen=True)
class Failure:
    """A row about a benchmark that raised an error."""

    work: str  # Its name
    error: str
    seconds: float
    met: bool = False


class Size(Enum):
    """How much a benchmark does: all; fewer repeats and sizes; or so little that it only runs."""

    FULL = 0
    QUICK = 1
    SMOKE = 2

    def pick(self, full: T, quick: T, smoke: T) -> T:
        """Return the one of three that is for this size."""
        return (full, quick, smoke)[self.value]


@dataclass(frozen=True)
class Child:
    """What a child took: wall and processor time in s, peak memory in MB, output, exit code."""

    seconds: float
    processor: float
    megabytes: float
    output: str
    code: int


def time_side_by_side(
    repeats: int, *functions: Callable[[], object]
) -> tuple[list[float], list[object]]:
    """Run all functions in turn, again and again; return median times and last results.

    Taking turns spreads a disturbance of the machine over all sides.
    """
    times, results = _in_turn(perf_counter, repeats, functions)
    return [median(series) for series in times], results


def least_side_by_side(
    repeats: int, *functions: Callable[[], object]
) -> tuple[list[float], list[object]]:
    """Run all functions in turn, again and again; return least processor times and last results.

    For work of some milliseconds: what else the machine does makes it longer, never shorter.
    """
    times, results = _in_turn(process_time, repeats, functions)
    return [min(series) for series in times], results


def _in_turn(
    clock: Callable[[], float], repeats: int, functions: Sequence[Callable[[], object]]
) -> tuple[list[list[float]], list[object]]:
    times: list[list[float]] = [[] for _ in functions]
    results: list[object] = [None] * len(functions)
    for _ in range(repeats):
        for i, function in enumerate(functions):
            start = clock()
            results[i] = function()
            times[i].append(clock() - start)
    return times, results


def prove(system: SwitchedSystem) -> Certification:
    """Certify without looking for the largest decay rate, which no peer here does either."""
    return certify(system, Method.AUTO, Limits(optimize_rate=False))


def run_child(command: Sequence[str], bytecode: str | None = None) -> Child:
    """Run a command in a cold process of its own.

    A small launcher waits for it: the peak memory that Linux reports for a child is never less
    than that of the process which started it. Python keeps compiled modules in the folder
    `bytecode`, as an installation would have compiled them.
    """
    environment = dict(os.environ)
    if bytecode is not None:
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        environment["PYTHONPYCACHEPREFIX"] = bytecode
    launcher = [sys.executable, "-I", "-S", str(LAUNCHER), *command]
    done = subprocess.run(launcher, capture_output=True, text=True, check=True, env=environment)
    return Child(**json.loads(done.stdout))


def machine_facts() -> str:
    """Describe the machine in one line."""
    cores = len(os.sched_getaffinity(0))
    libraries = ", ".join(f"{name} {_version(name)}" for name in LIBRARIES)
    return (
        f"{cores} cores, {_processor()}, load {os.getloadavg()[0]:.1f}, "
        f"{platform.system()} {platform.machine()}, Python {platform.python_version()}, {libraries}"
    )


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown processor"
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else "unknown processor"
