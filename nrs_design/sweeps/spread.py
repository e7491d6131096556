"""Points on several processes, or machines: each is computed until it is there.

A worker that dies takes no result with it: what it had not returned is computed again, in new
ones. The order in which results come back does not matter; whoever asks sorts them.
"""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from threading import Event, Thread
from typing import TypeVar

from nrs_design.errors import NrsDesignError
from nrs_design.processes import workers

T = TypeVar("T")
Work = Callable[[int], T]

# So many times in a row workers may die before the next result.
MAX_DEATHS = 3
# Every so many seconds a worker looks whether anybody still waits for it.
WATCH = 1.0
# Of a scheduler: enough chunks for each worker that none waits long for the last one.
CHUNKS_PER_WORKER, LARGEST_CHUNK = 8, 200


def map_in_processes(work: Work[T], points: Collection[int], jobs: int) -> Iterator[tuple[int, T]]:
    """Yield the number of each point with its result, as they come; one job is this process.

    The work can be pickled. A `NrsDesignError` if workers die again and again before any result.
    """
    if jobs == 1:
        yield from ((point, work(point)) for point in points)
        return
    from concurrent.futures.process import BrokenProcessPool

    left, deaths = set(points), 0
    while left:
        try:
            parallel = workers(jobs, _begin, os.getpid())
            for point, found in parallel((_numbered, (work, k), {}) for k in sorted(left)):
                left.discard(point)
                deaths = 0
                yield point, found
        except BrokenProcessPool:
            deaths += 1
            if deaths > MAX_DEATHS:
                raise NrsDesignError(
                    f"workers died {deaths} times in a row; {len(left)} points are left",
                    remedy="they may need more memory than there is: take fewer --jobs; what is "
                    "there is kept, and the same command goes on from it",
                ) from None


def _begin(run: int) -> None:
    """Let this worker be silent as its run is, and end when that is no more, however it ended."""
    # Warnings of libraries are for programmers.
    warnings.simplefilter("ignore")

    def watch() -> None:
        while os.getppid() == run:
            Event().wait(WATCH)
        os._exit(1)

    Thread(target=watch, daemon=True).start()


def _numbered(work: Work[T], point: int) -> tuple[int, T]:
    return point, work(point)


def spread_by_dask(work: Work[T], points: Sequence[int], scheduler: str) -> Iterator[tuple[int, T]]:
    """Yield the number of each point with its result, computed by the workers of a scheduler.

    The work can be pickled, and every worker has this program and its files. A `NrsDesignError` if
    dask.distributed is not installed, or there is no such scheduler.
    """
    try:
        from dask.distributed import Client, as_completed
    except ModuleNotFoundError:
        raise NrsDesignError(
            "--dask needs dask.distributed, which is not installed",
            remedy="pip install 'nrs-design[dask]', or leave --dask out and take --jobs",
        ) from None
    try:
        client = Client(scheduler)
    except (OSError, ValueError) as error:
        raise NrsDesignError(
            f"there is no scheduler at {scheduler} ({error})", remedy="start one: dask scheduler"
        ) from None
    with client:
        workers = max(1, len(client.scheduler_info()["workers"]))
        chunks = chunked(points, workers)
        # A worker that is lost is replaced by the scheduler, which gives its chunk to another.
        for future in as_completed(client.map(partial(_chunk, work), chunks, pure=False)):
            yield from future.result()


def chunked(points: Sequence[int], workers: int) -> list[Sequence[int]]:
    """Cut points into chunks, one for each task of a scheduler."""
    wanted = math.ceil(len(points) / (CHUNKS_PER_WORKER * workers))
    size = min(LARGEST_CHUNK, max(1, wanted))
    return [points[at : at + size] for at in range(0, len(points), size)]


def _chunk(work: Work[T], points: Sequence[int]) -> list[tuple[int, T]]:
    return [_numbered(work, point) for point in points]
