"""Tasks: lint, types and tests by default; slow tests and benchmarks by name."""

from __future__ import annotations

import nox

nox.options.sessions = ["lint", "types", "tests"]
nox.options.default_venv_backend = "venv"

# Who is done takes over from the other: some tests are a thousand times as long as others.
TWO_PROCESSES = ("-n", "2", "--dist", "worksteal")
CONSTRAINTS = ("-c", "constraints.txt")
SOURCES = ("nrs_design", "tests", "benchmarks", "docs", "noxfile.py")


@nox.session
def lint(session: nox.Session) -> None:
    session.install("ruff", *CONSTRAINTS)
    session.run("ruff", "check", *SOURCES)
    session.run("ruff", "format", "--check", *SOURCES)


@nox.session
def types(session: nox.Session) -> None:
    session.install(".", "mypy", "scipy-stubs", *CONSTRAINTS)
    session.run("mypy", "--num-workers", "2")


@nox.session
def tests(session: nox.Session) -> None:
    session.install(".[test]", *CONSTRAINTS)
    session.run("pytest", *TWO_PROCESSES, "-m", "not slow", *session.posargs)


@nox.session
def accessibility(session: nox.Session) -> None:
    """Hold pages against the rules of axe-core, which npm fetches, in Chromium."""
    session.install(".[test]", *CONSTRAINTS)
    folder = session.create_tmp()
    session.run("npm", "install", "--prefix", folder, "axe-core@4.14.1", external=True, silent=True)
    axe = f"{folder}/node_modules/axe-core/axe.min.js"
    session.run("pytest", "-k", "accessibility", "tests/reporting", env={"AXE": axe})


@nox.session
def coverage(session: nox.Session) -> None:
    """Every line and every branch of what decides is run by its own tests."""
    session.install(".[test]", *CONSTRAINTS)
    session.run("coverage", "run", "-m", "pytest", "-m", "not slow", "tests/proof")
    session.run("coverage", "report")


@nox.session
def mutation(session: nox.Session) -> None:
    """Make every small error in what decides, and run its tests: a quarter of an hour."""
    session.install(".[test]", *CONSTRAINTS)
    session.run("python", "-m", "tests.mutation", *session.posargs)


@nox.session
def slow(session: nox.Session) -> None:
    """Run the exhaustive tests that the default session leaves out, and many more examples."""
    session.install(".[test]", *CONSTRAINTS)
    chosen = ("-m", "slow or hypothesis", "--hypothesis-profile", "many")
    session.run("pytest", *TWO_PROCESSES, *chosen, *session.posargs)


@nox.session
def frama(session: nox.Session) -> None:
    """Analyze exported C for all inputs at once; for machines with Frama-C, which is large."""
    session.install(".[test]", *CONSTRAINTS)
    session.run("frama-c", "-version", external=True)
    session.run("pytest", "-m", "slow", "tests/exporters/test_eva.py")


@nox.session
def docs(session: nox.Session) -> None:
    """Build the documentation as plain files in site/; a broken link fails."""
    session.install(".[docs]", *CONSTRAINTS)
    session.run("python", "-m", "mkdocs", "build", *session.posargs)


@nox.session
def benchmarks(session: nox.Session) -> None:
    """Measure our speed beside the peers', as ratios in one run."""
    session.install(".[crosscheck]", *CONSTRAINTS)
    session.run("python", "-m", "benchmarks", *session.posargs)
