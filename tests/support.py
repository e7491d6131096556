"""Builders and exact oracles that several tests share."""

import contextlib
import gc
import io
import json
import os
import shutil
import subprocess
import sys
import warnings
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from functools import cache
from pathlib import Path
from time import process_time
from typing import Any, NoReturn
from unittest.mock import patch

import pytest
import typer

from nrs_design.certificates.catalogue import sentences
from nrs_design.cli import main
from nrs_design.proof.evidence.abstract import AbstractFunction
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import ARBITRARY, Switching
from nrs_design.proof.system import SwitchedSystem
from nrs_design.spec import LoadedSpec, read_spec
from tests.proof import truth

ROOT = Path(__file__).parents[1]
ROBOT = ROOT / "specs" / "neuroboscope"
SOFT_TISSUE = ROBOT / "soft-tissue.nrs.yaml"
FORCE_LIMIT = ROBOT / "force-limit.nrs.yaml"
COMMUTING = ROOT / "specs" / "examples" / "commuting.nrs.yaml"
# Edits of it: the gains of its withdrawal, given for what is designed.
GIVEN = (
    ("Mt: {min: 0.01 kg*m^2, max: 1 kg*m^2}", "Mt: 0.01 kg*m^2"),
    ("Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad}", "Bt: 1.04 N*m*s/rad"),
)
PRINT_ERROR = ROOT / "docs" / "examples" / "thesis-print-error.nrs.yaml"


# Processor seconds: several times what a slow machine needs, a small part of what a hang takes.
SOON = 20.0
Entry = int | str | Fraction
Rows = Sequence[Sequence[Entry]]
# Dayawansa and Martin 1999, a = 11.2: stable, but only a polynomial of about degree 40 shows it.
HARD = ([[-1, -1], [1, -1]], [[-1, "-11.2"], ["5/56", -1]])


def skip_for_want_of(what: str) -> NoReturn:
    """Skip a test that needs what is not there, except in CI, which must have it."""
    if os.environ.get("CI") == "true":
        pytest.fail(f"there is no {what} on this machine, and CI must have it")
    pytest.skip(f"there is no {what} on this machine")


def program_named(name: str) -> str:
    return shutil.which(name) or skip_for_want_of(name)


@contextlib.contextmanager
def ends_soon() -> Iterator[None]:
    """Fail if the block takes a hang's time: nothing here measures how fast a machine is."""
    start = process_time()
    yield
    assert process_time() - start < SOON


def matrix(rows: Rows) -> RationalMatrix:
    """Read a matrix of integers, fractions or exact decimals."""
    return RationalMatrix.from_rows([[Fraction(entry) for entry in row] for row in rows])


def family(
    *matrices: Rows,
    time: Time = Time.CONTINUOUS,
    switching: Switching = ARBITRARY,
    names: Sequence[str] | None = None,
) -> SwitchedSystem:
    """Make a system with modes m0, m1, ... of any sizes."""
    labels = names or [f"m{i}" for i in range(len(matrices))]
    modes = tuple(Mode(label, matrix(A)) for label, A in zip(labels, matrices, strict=True))
    states = tuple(f"x{i + 1}" for i in range(max(len(A) for A in matrices)))
    return SwitchedSystem(
        name="family", time=time, states=states, modes=modes, assumptions=(), switching=switching
    )


def dayawansa_martin(
    a: Entry, scale: Entry = 1, switching: Switching = ARBITRARY
) -> SwitchedSystem:
    """Quadratic iff a < 5.8284..., stable iff a < 11.2608... (Dayawansa and Martin 1999)."""
    a, c = Fraction(a), Fraction(scale)
    return family([[-c, -c], [c, -c]], [[-c, -c * a], [c / a, -c]], switching=switching)


def write_spec(
    path: Path, *matrices: Sequence[Sequence[Entry]], time: str = "continuous"
) -> LoadedSpec:
    lines = ["kind: switched-system", "name: given", f"time: {time}", "modes:"]
    for i, rows in enumerate(matrices):
        text = ", ".join("[" + ", ".join(f'"{Fraction(e)}"' for e in row) + "]" for row in rows)
        lines.append(f"  - {{name: m{i}, A: [{text}]}}")
    path.write_text("\n".join([*lines, "switching: arbitrary", ""]))
    return read_spec(path)


def spec_in(folder: Path, text: str, name: str = "a") -> Path:
    """Write a spec into a folder, and return where it is."""
    path = folder / f"{name}.nrs.yaml"
    path.write_text(text, encoding="utf-8")
    return path


# What the options of a command are is read from its function, and does not change.
PARAMETERS_OF = cache(typer.main.get_params_from_function)


def thinned(values: Iterable[Any], kept: int) -> list[Any]:
    """Parameters of which the default session takes the first only, the slow session the rest."""
    return [
        pytest.param(value, marks=[] if i < kept else [pytest.mark.slow])
        for i, value in enumerate(values)
    ]


def run(
    *arguments: str | Path | int, cwd: Path, code: int | None = None
) -> subprocess.CompletedProcess[str]:
    """Run the command line in this process, which takes a tenth of the time of a new one.

    What the start of Python, its streams or its environment decide is seen by `typed` only. A test
    fails unless the exit code is the one that is named.
    """
    done = _run(arguments, cwd)
    assert code in (None, done.returncode), f"{done.returncode}: {done.stderr}{done.stdout}"
    return done


def document_of(*arguments: str | Path | int, cwd: Path, code: int | None = None) -> Any:
    return json.loads(run(*arguments, "--json", cwd=cwd, code=code).stdout)


def _run(arguments: Sequence[str | Path | int], cwd: Path) -> subprocess.CompletedProcess[str]:
    command, code = ["nrs-design", *map(str, arguments)], 0
    threshold, settings = gc.get_threshold(), dict(os.environ)
    with (
        contextlib.chdir(cwd),
        patch.object(sys, "argv", command),
        patch.object(typer.main, "get_params_from_function", PARAMETERS_OF),
        contextlib.redirect_stdout(io.StringIO()) as out,
        contextlib.redirect_stderr(io.StringIO()) as err,
        warnings.catch_warnings(),
    ):
        try:
            main()
        except SystemExit as end:
            code = int(end.code or 0)
        finally:
            gc.set_threshold(*threshold)
            os.environ.clear()
            os.environ.update(settings)
    return subprocess.CompletedProcess(command, code, out.getvalue(), err.getvalue())


def started(
    *command: str | Path, cwd: Path, python: bool = True, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run a command in a process of its own, which finds the package: by default one of Python.

    A hang ends after half an hour, which nothing here takes.
    """
    words = [sys.executable, *command] if python else command
    settings = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    return subprocess.run(
        [*map(str, words)],
        capture_output=True,
        text=True,
        errors="surrogateescape",
        cwd=cwd,
        timeout=1800,
        check=False,
        env=settings,
    )


def typed(
    *arguments: str | Path | int,
    cwd: Path,
    environment: dict[str, str] | None = None,
    code: int | None = None,
) -> subprocess.CompletedProcess[str]:
    """Run the command line as a user types it, in a process of its own; see `run`."""
    done = started("-m", "nrs_design", *map(str, arguments), cwd=cwd, **(environment or {}))
    assert code in (None, done.returncode), f"{done.returncode}: {done.stderr}{done.stdout}"
    return done


def replaced(text: str, *changes: tuple[str, str]) -> str:
    """Replace pieces of a text, each of which must be there when its turn comes."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


def words_of(system: SwitchedSystem) -> tuple[str, ...]:
    """Return what a system takes for granted, in words."""
    return sentences(system.assumptions)


def number_in(text: str) -> Fraction:
    """Read a number of a claim, such as ``0.25`` or ``1 - 2.5e-22``."""
    return Fraction(text) if " - " not in text else 1 - Fraction(text.removeprefix("1 - "))


# Oracle: the definition of a kind of evidence.
holds = truth.holds


def broken(system: SwitchedSystem, evidence: AbstractFunction) -> set[str]:
    """Return where a function does not decrease at its rate, by another elimination."""
    return {
        failure.partition("rate ")[2]
        for failure, form in evidence.forms(system)
        if not truth.is_definite(form)
    }
