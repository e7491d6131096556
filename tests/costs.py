"""What each test takes, measured on an idle machine: it says in which session a test runs.

``python -m tests.costs`` runs all tests but the nightly ones in one process and writes `COSTS`, a
line for each test that is dear: that takes longer than `LIMIT`, or of what decides, `MORE`. A test
that is not there is in the default session and in CI. A dear one is in the nightly session, beside
those that mark themselves, and in CI if it is of what CI holds whatever that takes. Nothing is
measured while tests run otherwise: how fast a machine is decides nothing.
"""

import os
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from time import perf_counter

import pytest

COSTS = Path(__file__).with_name("costs.tsv")
# Seconds. The default session has thousands of tests.
LIMIT, MORE = 0.07, 0.25
DECIDES = tuple(f"tests/{name}/" for name in ("proof", "certificates", "literature", "pipeline"))
# What is published, every page prints what it shows; what the house is, with an addition and
# without a wing; and what commands load and begin with.
IN_CI = (
    *("tests/docs/", "tests/test_wings.py", "tests/test_additions.py", "tests/test_structure.py"),
    *("tests/cli/test_app.py", "tests/cli/test_init.py"),
    # That commands agree, checkers agree, and nothing that lies beside a spec is run.
    "tests/gating/test_agreement.py::test_all_commands_agree_on_any_design",
    *("tests/certificates/test_mutated.py", "tests/hostile/test_planted.py", "tests/oracle/"),
    # A refutation that only a long word of steps gives, once lost unseen.
    "tests/search/test_sampled_map.py",
)


@cache
def known_costs() -> dict[str, float]:
    """Return the measured seconds of each dear test by its name in pytest."""
    lines = (line.split("\t") for line in COSTS.read_text(encoding="utf-8").splitlines())
    return {name: float(seconds) for seconds, name in lines}


def name_of(item: pytest.Item) -> str:
    return item.nodeid.replace(f"{item.config.rootpath}/", "")


def seconds_of(item: pytest.Item) -> float:
    return known_costs().get(name_of(item), 0.0)


def is_dear(name: str, seconds: float) -> bool:
    return seconds > (MORE if name.startswith(DECIDES) else LIMIT)


def mark_by_cost(items: Sequence[pytest.Item]) -> None:
    for item in items:
        name = name_of(item)
        if is_dear(name, seconds_of(item)):
            item.add_marker(pytest.mark.slow)
            if not name.startswith(IN_CI):
                item.add_marker(pytest.mark.nightly)
        if item.get_closest_marker("nightly"):
            item.add_marker(pytest.mark.slow)


class Measurement:
    """A plugin that measures every test from its first fixture to its last."""

    def __init__(self) -> None:
        self.costs: dict[str, float] = {}

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        start = perf_counter()
        yield
        self.costs[name_of(item)] = perf_counter() - start


def main() -> int:
    measurement = Measurement()
    os.environ["CI"] = "true"
    code = pytest.main(["-q", "-m", "not nightly"], plugins=[measurement])
    costs = known_costs() | measurement.costs
    lines = [f"{cost:.2f}\t{name}" for name, cost in sorted(costs.items()) if is_dear(name, cost)]
    COSTS.write_text("\n".join([*lines, ""]), encoding="utf-8")
    return int(code)


if __name__ == "__main__":
    raise SystemExit(main())
