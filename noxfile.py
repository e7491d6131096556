"""Tasks: lint, types and tests by default; slow tests and benchmarks by name."""

from __future__ import annotations

import ast
import os
import shutil
from pathlib import Path

import nox
from nox.command import CommandFailed

nox.needs_version = ">=2025.10.14"
nox.options.sessions = ["lint", "types", "tests"]
nox.options.default_venv_backend = "virtualenv"

# A free process takes tests from the other: some take a thousand times as long as others.
TWO_PROCESSES = ("-n", "2", "--dist", "worksteal")
CONSTRAINTS = ("-c", "constraints.txt")
IN_ENVIRONMENT = {"venv_backend": "none", "requires": ["environment"]}
# Settings of pip for package indexes, and those of uv.
INDEX_SETTINGS = {
    "index-url": "UV_DEFAULT_INDEX",
    "extra-index-url": "UV_INDEX",
    "find-links": "UV_FIND_LINKS",
    "no-index": "UV_NO_INDEX",
}
# As in pyproject.toml.
PYTHONS = ("3.11", "3.12", "3.13")
SOURCES = ("nrs_design", "tests", "benchmarks", "docs", "noxfile.py")


@nox.session
def lint(session: nox.Session) -> None:
    session.install("ruff", "vulture", *CONSTRAINTS)
    session.run("ruff", "check", *SOURCES)
    session.run("ruff", "format", "--check", *SOURCES)
    session.run("vulture")


@nox.session
def environment(session: nox.Session) -> None:
    """Install the package with the needs of tests, mypy and pages, once for all sessions."""
    install(session, ".[docs,test]", "mypy", "scipy-stubs")


def install(session: nox.Session, *wanted: str) -> None:
    """Install by uv, in a tenth of the time of pip; by pip where uv fails. Compile nothing."""
    quick = ("uv", "pip", "install", "--quiet", "--reinstall-package", "nrs-design")
    try:
        session.install("uv", *CONSTRAINTS)
        session.run_install(*quick, *wanted, *CONSTRAINTS, env=index_settings(session))
    except CommandFailed:
        session.install("--no-compile", *wanted, *CONSTRAINTS)


def index_settings(session: nox.Session) -> dict[str, str]:
    """Return the settings of uv for the indexes of pip, all of the same priority."""
    listed = session.run_install("python", "-m", "pip", "config", "list", silent=True)
    settings = [line.partition("=") for line in str(listed or "").splitlines()]
    env = {"UV_INDEX_STRATEGY": "unsafe-best-match"}
    # For pip, too, the environment overrides files.
    for name, _, value in sorted(settings, key=lambda setting: setting[0].startswith(":env:")):
        if setting := INDEX_SETTINGS.get(name.rpartition(".")[2]):
            env[setting] = " ".join(ast.literal_eval(value).split())
    return env


def run_there(session: nox.Session, program: str, *arguments: str, **settings: str) -> None:
    """Run a program of the environment, which keeps the bytecode of its imports."""
    programs = session.env_dir.parent / "environment" / "bin"
    path = f"{programs}{os.pathsep}{os.environ['PATH']}"
    env = {"PATH": path, "PYTHONDONTWRITEBYTECODE": None, **settings}
    session.run(str(programs / program), *arguments, env=env, external=True)


@nox.session(**IN_ENVIRONMENT)
def types(session: nox.Session) -> None:
    run_there(session, "mypy", "--num-workers", "2")


@nox.session(**IN_ENVIRONMENT)
def tests(session: nox.Session) -> None:
    """Run all but slow tests; in CI those too, without `tests/proof`, which `coverage` runs."""
    chosen = ("-m", "not slow")
    if os.environ.get("CI") == "true":
        chosen = ("-m", "not nightly", "--ignore=tests/proof")
    run_there(session, "pytest", *TWO_PROCESSES, *chosen, *session.posargs)


@nox.session(**IN_ENVIRONMENT)
def accessibility(session: nox.Session) -> None:
    """Check reports and the pages in site/ by the rules of axe-core, in Chromium."""
    folder = session.create_tmp()
    session.run("npm", "install", "--prefix", folder, "axe-core@4.14.1", external=True, silent=True)
    axe = f"{folder}/node_modules/axe-core/axe.min.js"
    pages = ("tests/reporting/test_browser.py", "tests/docs/test_built_pages.py")
    run_there(session, "pytest", *TWO_PROCESSES, "-k", "accessibility", *pages, AXE=axe)


@nox.session(**IN_ENVIRONMENT)
def coverage(session: nox.Session) -> None:
    """Run every line and branch of the kernel by its own tests."""
    measured = ("--cov", "--cov-report=term:skip-covered")
    run_there(session, "pytest", *TWO_PROCESSES, "-m", "not nightly", *measured, "tests/proof")


@nox.session(**IN_ENVIRONMENT)
def mutation(session: nox.Session) -> None:
    """Make every small error in the kernel, and run its tests: half an hour."""
    run_there(session, "python", "-m", "tests.mutation", *session.posargs)


@nox.session(**IN_ENVIRONMENT)
def nightly(session: nox.Session) -> None:
    """Run the studies, many more examples of every property, and all benchmarks: an hour."""
    chosen = ("-m", "nightly or hypothesis", "--hypothesis-profile", "many")
    run_there(session, "pytest", *TWO_PROCESSES, *chosen, *session.posargs)
    # Only that each runs; `benchmarks` measures.
    run_there(session, "python", "-m", "benchmarks", "--smoke")


@nox.session(**IN_ENVIRONMENT)
def frama(session: nox.Session) -> None:
    """Analyze exported C for all inputs at once; for machines with Frama-C, which is large."""
    session.run("frama-c", "-version", external=True)
    run_there(session, "pytest", "-m", "slow or nightly", "tests/exporters/test_eva.py")


@nox.session(**IN_ENVIRONMENT)
def docs(session: nox.Session) -> None:
    """Build the documentation as plain files in site/; a broken link fails."""
    run_there(session, "python", "-m", "mkdocs", "build", *session.posargs)


@nox.session
def package(session: nox.Session) -> None:
    """Build sdist and wheel; from the wheel, re-check what is committed on each Python here."""
    session.install("build", "twine", "uv", *CONSTRAINTS)
    folder = Path(session.create_tmp()).resolve()
    shutil.rmtree(folder)
    session.run("python", "-m", "build", "--outdir", str(folder))
    source, wheel = sorted(map(str, folder.iterdir()), reverse=True)
    session.run("twine", "check", "--strict", source, wheel)
    env = index_settings(session) | {"UV_PYTHON_DOWNLOADS": "never"}
    for python in PYTHONS:
        place = folder / f"python{python}"
        # 2: this machine has no such Python.
        create = ("uv", "venv", "--quiet", "--python", python, str(place))
        session.run(*create, env=env, success_codes=(0, 2))
        if place.exists():
            of = ("--quiet", "--python", str(place), *CONSTRAINTS)
            session.run("uv", "pip", "install", *of, wheel, env=env)
            program = str(place / "bin" / "nrs-design")
            session.run(program, "gate", "specs/", "--locked", external=True)


@nox.session(**IN_ENVIRONMENT)
def benchmarks(session: nox.Session) -> None:
    """Measure our speed beside the peers', as ratios in one run."""
    run_there(session, "python", "-m", "benchmarks", *session.posargs)
