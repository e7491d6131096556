"""Points on several processes: one that is killed loses nothing."""

import os
import sys
from concurrent.futures import Future
from functools import partial
from types import SimpleNamespace

import pytest

from nrs_design.errors import NrsDesignError
from nrs_design.sweeps.spread import chunked, map_in_processes, spread_by_dask
from tests.sweeps.work import always_killed, killed_once, square


def test_points_of_one_process_come_in_order():
    assert list(map_in_processes(square, range(3), 1)) == [(0, 0), (1, 1), (2, 4)]


def test_a_killed_worker_loses_nothing(tmp_path):
    found = list(map_in_processes(partial(killed_once, tmp_path), range(8), 2))
    assert (tmp_path / "killed").exists()
    assert sorted(found) == [(point, point * point) for point in range(8)]


def test_workers_that_always_die_end_in_an_error():
    with pytest.raises(NrsDesignError, match="died 4 times in a row; 2 points are left"):
        list(map_in_processes(partial(always_killed, os.getpid()), range(2), 2))


@pytest.mark.parametrize(("count", "workers"), [(1, 4), (1000, 2), (100_000, 3)])
def test_chunks_hold_every_point_once(count, workers):
    chunks = chunked(range(count), workers)
    assert [point for chunk in chunks for point in chunk] == list(range(count))
    assert max(map(len, chunks)) <= 200


class Scheduler:
    """What is asked of a client of dask.distributed, with two workers that answer at once."""

    def __init__(self, address):
        if address != "tcp://there:1":
            raise OSError("timed out")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def scheduler_info(self):
        return {"workers": {"a": {}, "b": {}}}

    def map(self, work, chunks, *, pure):
        assert not pure
        futures = []
        for chunk in chunks:
            futures.append(Future())
            futures[-1].set_result(work(chunk))
        return futures


def test_a_scheduler_is_given_chunks(monkeypatch):
    dask = SimpleNamespace(Client=Scheduler, as_completed=reversed)
    monkeypatch.setitem(sys.modules, "dask", SimpleNamespace(distributed=dask))
    monkeypatch.setitem(sys.modules, "dask.distributed", dask)
    found = list(spread_by_dask(square, range(100), "tcp://there:1"))
    assert sorted(found) == [(point, point * point) for point in range(100)]
    with pytest.raises(NrsDesignError, match="there is no scheduler at tcp://elsewhere:1"):
        list(spread_by_dask(square, range(2), "tcp://elsewhere:1"))


def test_without_the_extra_there_is_one_clear_message(monkeypatch):
    monkeypatch.setitem(sys.modules, "dask", None)
    with pytest.raises(NrsDesignError, match="not installed") as caught:
        list(spread_by_dask(square, range(2), "tcp://127.0.0.1:1"))
    assert "nrs-design[dask]" in (caught.value.remedy or "")
