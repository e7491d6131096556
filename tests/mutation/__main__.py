"""Run the tests of `nrs_design/proof/`, and of what encloses a loop, once for every mutant."""

from __future__ import annotations

import gc
import importlib
import os
import resource
import signal
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import pairwise
from multiprocessing.sharedctypes import RawArray, RawValue
from pathlib import Path
from time import process_time

import hypothesis
import pytest

from tests.mutation.graft import graft
from tests.mutation.mutants import Mutant, mutants

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "nrs_design"
PROOF = PACKAGE / "proof"
TESTS = ROOT / "tests" / "proof"
KINDS = TESTS / "evidence"
ROWS = TESTS / "test_rows.py"
EQUIVALENT = Path(__file__).with_name("equivalent.toml")
# Files of evidence that are no kind, or all: what tampers with examples is the mirror of the last.
SHARED = {"abstract", "fields", "__init__"}
# What decides for a kind in a file of its own, and the kind that tests it.
DECIDES_FOR = {"growth": "growing_sequence"}
# A kind of which the examples that are tampered with are named by their shapes.
EXAMPLES_OF = {"graph": "quadratic or polynomial"}
# What decides for several kinds is held by their tests, too.
BESIDE = {
    "steps": (
        ROWS,
        KINDS / "test_graph.py",
        KINDS / "test_invariant_ellipsoid.py",
        TESTS / "test_offset.py",
        TESTS / "test_stays.py",
    ),
    "stays": (ROWS, KINDS / "test_graph.py"),
    "__init__": (KINDS / "test_tampering.py",),
    "contradiction": (ROWS, TESTS / "test_saturation.py"),
    "fields": (KINDS / "test_tampering.py",),
    "enclosure": (ROWS, KINDS / "test_growing_sequence.py", TESTS / "test_stays.py"),
    "saturation": (
        ROWS,
        KINDS / "test_saturated_ellipsoid.py",
    ),
    "switching": (ROWS, TESTS / "test_clock.py", KINDS / "test_growing_sequence.py"),
    "system": (TESTS / "test_clock.py", TESTS / "test_contact.py"),
}
# What decides beside the proof: modes that enclose too little prove too much, and what has a veto.
ELSEWHERE = {
    PACKAGE / f"{name}.py": [str(ROOT / "tests" / test) for test in tests]
    for name, tests in {
        "loop/entries": ("loop/test_entries.py", "loop/test_flow.py"),
        "loop/hull": ("loop/test_hull.py", "loop/test_flow.py"),
        "certificates/second_opinion": ("certificates/test_second_opinion.py",),
        "controllers/taylor": ("controllers/test_taylor.py",),
        "design/largest_ratio": ("design/test_largest_ratio.py",),
        "spec/power": ("spec/test_power.py",),
    }.items()
}
# A mutant may loop for ever, or count to the end of memory. A test gets so many times what it
# takes without a change, and so many seconds more.
TIMES, SECONDS, BYTES = 5, 5, 4 << 30
# The same few examples each time, none remembered, and none made smaller.
hypothesis.settings.register_profile(
    "mutation",
    max_examples=20,
    derandomize=True,
    database=None,
    deadline=None,
    phases=(hypothesis.Phase.explicit, hypothesis.Phase.generate),
)
OPTIONS = ("-x", "-s", "--hypothesis-profile", "mutation")
# Nothing is reported but by us, and hypothesis is loaded before pytest could rewrite its asserts.
QUIET = ("-qq", "--no-header", "--no-summary", "-p", "no:cacheprovider", "-p", "no:xdist")
QUIET += ("-W", "ignore::pytest.PytestAssertRewriteWarning")


class Examination:
    """A plugin of pytest that runs what was collected once for every mutant of a module.

    Each run is a process of its own, begun when all is imported and collected.
    """

    def __init__(self, name: str, path: Path, candidates: Iterable[Mutant]) -> None:
        self.name, self.path, self.candidates = name, path, candidates
        self.order: list[int] = []
        self.unnoticed: list[str] = []
        self.running: dict[int, str] = {}

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Take the place of the one run of the tests."""
        # In memory that the processes share: what each test took, and which one is run.
        self.took = RawArray("d", [60.0] * len(session.items))
        self.running_test = RawValue("i")
        self.order = list(range(len(session.items)))
        # In this process, so that what a search has found is there for all mutants.
        if self.run(session, None):
            raise session.Failed(f"{self.name}: its tests fail without any change")
        signal.setitimer(signal.ITIMER_PROF, 0)
        self.order.sort(key=self.took.__getitem__)
        # So that no process copies what is there already, only to look through it.
        gc.freeze()
        for mutant in self.candidates:
            if len(self.running) == len(os.sched_getaffinity(0)):
                self.wait()
            self.running[self.start(session, mutant)] = mutant.name
        while self.running:
            self.wait()
        return True

    def wait(self) -> None:
        """Wait for one process; it ends with 0 if all tests passed."""
        pid, status = os.wait()
        name = self.running.pop(pid)
        if status == 0:
            self.unnoticed.append(name)
            print(f"  {name}", flush=True)
            return
        # What has noticed one mutant notices the next as well, as a rule; others by what they take.
        killer = self.running_test.value
        self.order.remove(killer)
        self.order.insert(0, killer)

    def start(self, session: pytest.Session, mutant: Mutant) -> int:
        """Begin the run for a mutant."""
        if pid := os.fork():
            return pid
        status, silence = 1, os.open(os.devnull, os.O_WRONLY)
        os.dup2(silence, 1)
        os.dup2(silence, 2)
        resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
        try:
            status = self.run(session, mutant)
        finally:
            os._exit(status)

    def run(self, session: pytest.Session, mutant: Mutant | None) -> int:
        """Run the tests up to the first failure."""
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        if mutant:
            graft(importlib.import_module(self.name), mutant.compile(self.path))
            forget()
        items = [*(session.items[k] for k in self.order), None]
        for k, (item, following) in zip(self.order, pairwise(items), strict=True):
            self.running_test.value, begin = k, process_time()
            signal.setitimer(signal.ITIMER_PROF, SECONDS + TIMES * self.took[k])
            session.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
            if session.testsfailed:
                return 1
            if not mutant:
                self.took[k] = process_time() - begin
        return 0


def forget() -> None:
    """Clear what functions of the proof keep of what they have computed."""
    for name in [name for name in sys.modules if name.startswith("nrs_design.proof.")]:
        for thing in vars(sys.modules[name]).values():
            if hasattr(thing, "cache_clear"):
                thing.cache_clear()


def main(names: list[str]) -> int:
    """Examine some modules, such as ``proof/graph``, or all; return how many nobody noticed."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    os.chdir(ROOT)
    total = sum((examine(path, listed()) for path in chosen(names)), Counter())
    print(in_words(total))
    return total["unnoticed"]


def chosen(names: list[str]) -> Iterator[Path]:
    """Yield the modules that are asked for; without names, all that hold a function."""
    if not names:
        every = (*sorted(PROOF.rglob("*.py")), *ELSEWHERE)
        yield from (path for path in every if mutants(path.read_text()))
    for name in names:
        yield PACKAGE / f"{name}.py"


def listed() -> dict[str, dict[str, str]]:
    """Read the mutants that decide the same, by module, each with the reason."""
    return tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))


def examine(path: Path, reasons: dict[str, dict[str, str]]) -> Counter[str]:
    """Run every mutant of a module that is not listed, and print those that no test noticed."""
    module = path.relative_to(PACKAGE).with_suffix("").as_posix()
    known = reasons.get(module.removeprefix("proof/"), {})
    every = mutants(path.read_text(encoding="utf-8"))
    if path.parent.name == "loop":
        # Its constants say how near what encloses is: whatever they are, it does.
        every = [mutant for mutant in every if not mutant.name.startswith("module: ")]
    candidates = [mutant for mutant in every if mutant.name not in known]
    name = f"nrs_design.{module.replace('/', '.')}".removesuffix(".__init__")
    examination = Examination(name, path, candidates)
    if pytest.main([*OPTIONS, *QUIET, *own_tests(path)], plugins=[examination]):
        sys.exit(f"{module}: its tests fail without any change")
    unnoticed = len(examination.unnoticed)
    count = Counter(
        mutants=len(every),
        killed=len(candidates) - unnoticed,
        equivalent=len(known),
        unnoticed=unnoticed,
    )
    print(f"{module}: {in_words(count)}", flush=True)
    return count


def in_words(count: Counter[str]) -> str:
    """Say how many mutants there are, and what became of them."""
    words = ("mutants", "killed", "equivalent", "unnoticed")
    return ", ".join(f"{count[word]} {word}" for word in words)


def own_tests(path: Path) -> list[str]:
    """Return what mirrors a module, and for a kind of evidence the tests of all kinds, too."""
    if path in ELSEWHERE:
        return ELSEWHERE[path]
    path = path.with_stem(DECIDES_FOR.get(path.stem, path.stem))
    mirror = TESTS / path.relative_to(PROOF).with_name(f"test_{path.name}")
    if path.parent == PROOF or path.stem in SHARED:
        own = mirror if mirror.exists() else ROWS
        return [str(own), *map(str, BESIDE.get(path.stem, ()))]
    of_all = (ROWS, KINDS / "test_abstract.py", KINDS / "test_tampering.py")
    kind = EXAMPLES_OF.get(path.stem, path.stem.replace("_", "-"))
    return [str(mirror), *map(str, of_all), "-k", f"not tampering or {kind}"]


if __name__ == "__main__":
    sys.exit(min(main(sys.argv[1:]), 1))
