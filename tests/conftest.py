"""Settings of libraries, for all tests.

One thread for small matrices, as the commands of the program set it: tests run side by side. And no
deadline for examples of hypothesis: how fast a machine is decides nothing. By default they are few
and the same each time; the nightly session draws many, and others each time.

Where no bytecode may be kept beside the sources, commands that run in processes of their own keep
it in the cache of pytest: to compile all modules takes as long as to run them.

Tests are marked `slow` and `nightly` by what they were measured to take (`tests/costs.py`), and the
dearest begin first: who began one last would end alone.

Every process imports all tests. The second one begins with the last folder, so that each finds half
of them compiled by the other; both have to list them in one order.

What is collected stays until the end, so no search for garbage looks at it again; and the searches
are as rare as in the program itself.
"""

import gc
import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from tests.browser import axe, browser
from tests.costs import mark_by_cost, seconds_of

__all__ = ["axe", "browser"]

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Lines are found whole; how they are broken is tested by itself.
os.environ["COLUMNS"] = "10000"
settings.register_profile("few", deadline=None, max_examples=15, derandomize=True)
settings.register_profile("many", deadline=None, max_examples=100)
settings.load_profile("few")


def pytest_configure(config: pytest.Config) -> None:
    cache = getattr(config, "cache", None)
    if cache is not None and os.environ.pop("PYTHONDONTWRITEBYTECODE", ""):
        os.environ.setdefault("PYTHONPYCACHEPREFIX", str(cache.mkdir("bytecode")))
    if os.environ.get("PYTEST_XDIST_WORKER") == "gw1":
        ignored = {Path(path).resolve() for path in config.getoption("ignore") or ()}
        listed = [path for argument in config.args for path in _backwards(argument)]
        config.args = [path for path in listed if Path(path).resolve() not in ignored]


def _backwards(argument: str) -> list[str]:
    """Return what is in a folder of tests, the last first; what is no folder as it is."""
    folder = Path(argument)
    if not folder.is_dir():
        return [argument]
    inside = sorted(folder.iterdir(), reverse=True)
    return [str(path) for path in inside if path.is_dir() or path.match("test_*.py")]


@pytest.hookimpl(wrapper=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> Iterator[None]:
    items.sort(key=lambda item: item.nodeid.partition("::")[0])
    mark_by_cost(items)
    yield
    items.sort(key=seconds_of, reverse=True)


def pytest_collection_finish() -> None:
    gc.collect()
    gc.freeze()
    gc.set_threshold(200_000)


def pytest_runtest_teardown() -> None:
    """Put back a limit that a command lifts, which is run in the process of the tests."""
    sys.set_int_max_str_digits(sys.int_info.default_max_str_digits)
