"""Work on several processes: each point once, and a worker that dies is no silence."""

import os
from functools import partial
from multiprocessing import get_context
from time import sleep

import pytest

from nrs_design.errors import NrsDesignError
from nrs_design.pipeline.processes import map_in_processes
from tests.pipeline.work import killed, square


@pytest.mark.parametrize("jobs", [1, 2])
def test_every_point_comes_once(jobs):
    before = dict(os.environ)
    found = list(map_in_processes(square, [3, 4, 5], jobs))
    assert dict(os.environ) == before
    assert sorted(found) == [(0, 9), (1, 16), (2, 25)]


def test_processes_of_others_go_on():
    other = get_context("spawn").Process(target=sleep, args=(60,))
    other.start()
    try:
        assert len(list(map_in_processes(square, range(2), 2))) == 2
        assert other.is_alive()
    finally:
        other.kill()
        other.join()


def test_a_worker_that_dies_ends_in_an_error():
    with pytest.raises(NrsDesignError, match="fewer --jobs"):
        list(map_in_processes(partial(killed, os.getpid()), range(2), 2))
