"""Run the tests of `nrs_design/proof/` once for every mutant: nox -s mutation -- exact lyapunov."""

from __future__ import annotations

import importlib
import os
import resource
import signal
import sys
import tomllib
from collections.abc import Iterator
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, SourceFileLoader
from importlib.util import spec_from_file_location
from pathlib import Path
from types import CodeType

from tests.mutation.mutants import Mutant, mutants

ROOT = Path(__file__).parents[2]
PROOF = ROOT / "nrs_design" / "proof"
TESTS = ROOT / "tests" / "proof"
EQUIVALENT = Path(__file__).with_name("equivalent.toml")
# Files of evidence that are no kind.
SHARED = {"abstract", "fields", "flow", "__init__"}
# Imported once for all: what is not ours, and what the tests of `proof` need.
FOREIGN = ("numpy", "scipy.linalg", "scipy.optimize", "flint", "clarabel", "hypothesis", "pydantic")
# A mutant may loop for ever, or count to the end of memory: for each test, and for the process.
SECONDS, BYTES = 30, 4 << 30


class MutatedLoader(SourceFileLoader):
    """Loads one module from code that was compiled with a change."""

    def __init__(self, name: str, path: Path, code: CodeType) -> None:
        super().__init__(name, str(path))
        self.code = code

    def get_code(self, fullname: str) -> CodeType:
        return self.code


class MutatedFinder(MetaPathFinder):
    """Finds one module, before anybody else does."""

    def __init__(self, path: Path, code: CodeType) -> None:
        parts = path.relative_to(ROOT).with_suffix("").parts
        self.name = ".".join(parts).removesuffix(".__init__")
        self.path, self.code = path, code

    def find_spec(self, fullname: str, path: object, target: object = None) -> ModuleSpec | None:
        if fullname != self.name:
            return None
        loader = MutatedLoader(fullname, self.path, self.code)
        return spec_from_file_location(fullname, self.path, loader=loader)


class Clock:
    """A plugin of pytest that ends the process when a test takes too long."""

    def pytest_runtest_setup(self) -> None:
        signal.setitimer(signal.ITIMER_PROF, SECONDS)


def main(names: list[str]) -> int:
    """Examine some modules of `proof`, or all; return how many mutants nobody noticed."""
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    for name in FOREIGN:
        importlib.import_module(name)
    return sum(examine(path, listed()) for path in chosen(names))


def chosen(names: list[str]) -> Iterator[Path]:
    """Yield the modules that are asked for; without names, all that hold a function."""
    if not names:
        yield from (path for path in sorted(PROOF.rglob("*.py")) if mutants(path.read_text()))
    for name in names:
        yield PROOF / f"{name}.py"


def listed() -> dict[str, dict[str, str]]:
    """Read the mutants that decide the same, by module, each with the reason."""
    return tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))


def examine(path: Path, reasons: dict[str, dict[str, str]]) -> int:
    """Run every mutant of a module that is not listed, and print those that no test noticed."""
    module = path.relative_to(PROOF).with_suffix("").as_posix()
    known = reasons.get(module, {})
    every = mutants(path.read_text(encoding="utf-8"))
    if os.waitpid(_start(path, None), 0)[1]:
        sys.exit(f"{module}: its tests fail without any change")
    survivors = list(survivors_of(path, [mutant for mutant in every if mutant.name not in known]))
    print(f"{module}: {len(every)} mutants, {len(known)} equivalent, {len(survivors)} unnoticed")
    for name in survivors:
        print(f"  {name}", flush=True)
    return len(survivors)


def survivors_of(path: Path, candidates: list[Mutant]) -> Iterator[str]:
    """Yield the names of mutants that all tests accept, with one process for each core."""
    running: dict[int, str] = {}
    for mutant in candidates:
        if len(running) == len(os.sched_getaffinity(0)):
            yield from _survivor(running)
        running[_start(path, mutant)] = mutant.name
    while running:
        yield from _survivor(running)


def _survivor(running: dict[int, str]) -> Iterator[str]:
    """Wait for one process; it ends with 0 if all tests passed."""
    pid, status = os.wait()
    name = running.pop(pid)
    if status == 0:
        yield name


def _start(path: Path, mutant: Mutant | None) -> int:
    sys.stdout.flush()
    if pid := os.fork():
        return pid
    status = 1
    try:
        status = _run_tests(path, mutant)
    finally:
        os._exit(status)


def _run_tests(path: Path, mutant: Mutant | None) -> int:
    """Run the module's own tests up to the first failure."""
    silence = os.open(os.devnull, os.O_WRONLY)
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
    signal.setitimer(signal.ITIMER_PROF, SECONDS)
    if mutant:
        sys.meta_path.insert(0, MutatedFinder(path, mutant.compile(path)))

    import hypothesis
    import pytest

    # The same examples each time, none remembered, and none made smaller.
    phases = (hypothesis.Phase.explicit, hypothesis.Phase.generate)
    hypothesis.settings.register_profile(
        "mutation", derandomize=True, database=None, deadline=None, phases=phases
    )
    os.chdir(ROOT)
    options = ["-x", "-q", "-m", "not slow", "-p", "no:cacheprovider", "-p", "no:xdist"]
    options += ["--hypothesis-profile", "mutation"]
    # pytest would have rewritten the asserts of plugins that are loaded already.
    options += ["-W", "ignore::pytest.PytestAssertRewriteWarning"]
    for tests in own_tests(path):
        if status := pytest.main([*options, *tests], plugins=[Clock()]):
            return int(status)
    return 0


def own_tests(path: Path) -> Iterator[list[str]]:
    """Yield what mirrors a module, and for a kind of evidence the tampering with its examples."""
    mirror = TESTS / path.relative_to(PROOF).with_name(f"test_{path.name}")
    yield [str(mirror if mirror.exists() else TESTS)]
    if path.parent != PROOF and path.stem not in SHARED:
        yield [str(TESTS / "evidence/test_tampering.py"), "-k", path.stem.replace("_", "-")]


if __name__ == "__main__":
    sys.exit(min(main(sys.argv[1:]), 1))
