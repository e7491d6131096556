"""Start of other programs and workers, which import and run nothing of the working folder.

That may be a stranger's, as the checkout is that a gate judges.
"""

from __future__ import annotations

import os
import subprocess
import warnings
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TypeVar

from nrs_design.errors import NrsDesignError

P = TypeVar("P")
T = TypeVar("T")

# Every Python process with this variable leaves the working folder out of `sys.path`.
SAFE_PATH = {"PYTHONSAFEPATH": "1"}


def run_program(
    program: str, arguments: Iterable[str], folder: str | Path
) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder that holds what this process has put there, and nothing else."""
    return subprocess.run(
        [os.path.abspath(program), *arguments],
        cwd=folder,
        env=os.environ | SAFE_PATH,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
        errors="replace",
    )


def map_in_processes(
    work: Callable[[P], T], points: Iterable[P], jobs: int
) -> Iterator[tuple[int, T]]:
    """Yield the number of each point with its result, as they come; one job is this process.

    Work and points can be pickled. A `NrsDesignError` if a worker dies.
    """
    if jobs == 1:
        yield from enumerate(map(work, points))
        return
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import active_children, get_context

    # Workers start at any time until the last result is there.
    before, others = os.environ.copy(), active_children()
    os.environ |= SAFE_PATH
    pool = ProcessPoolExecutor(jobs, get_context("spawn"), _begin)
    try:
        coming = {pool.submit(work, point): number for number, point in enumerate(points)}
        for future in as_completed(coming):
            yield coming.pop(future), future.result()
    except BrokenProcessPool:
        raise NrsDesignError(
            "a process died that computed for this one",
            remedy="there may be too little memory for so many: take fewer --jobs",
        ) from None
    finally:
        # Results of remaining workers are not needed.
        for worker in active_children():
            if worker not in others:
                worker.terminate()
        pool.shutdown(cancel_futures=True)
        for name in os.environ.keys() - before.keys():
            del os.environ[name]
        os.environ |= before


def _begin() -> None:
    """Let this worker be silent as its run is, and end when that is no more, however it ended."""
    from multiprocessing import parent_process
    from threading import Thread

    # Warnings of libraries are for programmers.
    warnings.simplefilter("ignore")
    run = parent_process()
    assert run is not None, "a worker has one"

    def watch() -> None:
        run.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()
