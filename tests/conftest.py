"""Settings of libraries, for all tests.

One thread for small matrices, as the commands of the program set it: tests run side by side. And no
deadline for examples of hypothesis: how fast a machine is decides nothing. By default they are few
and the same each time; the slow session draws many, and others each time.

Where no bytecode may be kept beside the sources, commands that run in processes of their own keep
it in the cache of pytest: to compile all modules takes as long as to run them.

A test that takes minutes says how many seconds, `slow(seconds=...)`, and begins before the others:
who began it last would end alone.

What is collected stays until the end, so no search for garbage looks at it again; and the searches
are as rare as in the program itself.
"""

import gc
import os

import pytest
from hypothesis import settings

from nrs_design.cli import COLLECT_AFTER

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
settings.register_profile("few", deadline=None, max_examples=25, derandomize=True)
settings.register_profile("many", deadline=None, max_examples=100)
settings.load_profile("few")


def pytest_configure(config: pytest.Config) -> None:
    cache = getattr(config, "cache", None)
    if cache is not None and os.environ.pop("PYTHONDONTWRITEBYTECODE", ""):
        os.environ.setdefault("PYTHONPYCACHEPREFIX", str(cache.mkdir("bytecode")))


def _seconds(item: pytest.Item) -> float:
    return max((mark.kwargs.get("seconds", 0.0) for mark in item.iter_markers("slow")), default=0.0)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=_seconds, reverse=True)


def pytest_collection_finish() -> None:
    gc.collect()
    gc.freeze()
    gc.set_threshold(COLLECT_AFTER)
