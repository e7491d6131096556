"""One point of a sweep: a command, run in this process on a spec that says something else.

A point depends on what its spec means, on the command with its options, and on the version of this
program, and on nothing else. So an answer that is kept is used again, except for what it claims to
be proved: that is used only if the certificate beside it is checked again here, and shows the same.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from nrs_design import __version__
from nrs_design.axis import about
from nrs_design.cli import exit_codes
from nrs_design.cli.errors import error_summary
from nrs_design.cli.printing import taking_json
from nrs_design.errors import CertificateError, ClockError, NrsDesignError
from nrs_design.spec import LoadedSpec
from nrs_design.spec.document import Data
from nrs_design.spec.edits import saying_instead
from nrs_design.spec.load import read_axes
from nrs_design.spec.task_space import file_of
from nrs_design.sweeps.claims import is_shown
from nrs_design.sweeps.grid import Grid
from nrs_design.sweeps.store import CachedAnswer, Store, key_of

# Commands that write a certificate, to the place that this option names.
CERTIFYING = {"certify-switching": "--out"}
# What no two runs have in common; what is said of other specs, which no certificate here shows; and
# advice about the file, which is not what the point is about.
LEFT_OUT = frozenset({"seconds", "certificate", "files", "path", "blocked_by", "next_steps", "rho"})


@dataclass(frozen=True, slots=True)
class Job:
    """What is done at every point."""

    spec: Path  # The file, or an axis of one
    grid: Grid
    command: tuple[str, ...]  # Its words, such as ``("robot", "dynamics")``
    options: tuple[str, ...]  # As they are typed
    asked: tuple[str, ...]  # The same command and options, however they were typed
    store: Store


@dataclass(frozen=True, slots=True)
class PointAnswer:
    """What came of one point."""

    texts: tuple[str, ...]  # Values of the fields, in their order
    code: int  # As the command ends with
    # Of the answer in the store, and the hash of that answer; empty where there is none.
    key: str = ""
    id: str = ""
    error: Mapping[str, Any] | None = None  # What is wrong, if that kept it from an answer
    # Whether the answer was there already. It makes no difference to it.
    reused: bool = field(default=False, compare=False)


def answer_point(job: Job, index: int) -> PointAnswer:
    """Return what comes of one point: kept, or computed and kept."""
    texts = job.grid.texts(index)
    with saying_instead(file_of(job.spec), job.grid.changes(index)):
        try:
            axes = read_axes(job.spec)
            key = _key(job, axes)
            kept = job.store.read(key)
            if kept is not None and _holds(kept, _shown(job.store.certificate(key), axes)):
                return PointAnswer(texts, kept.code, key, kept.id(key), reused=True)
            job.store.drop_certificate(key)
            kept = _computed(job, key)
            job.store.write(key, kept)
            return PointAnswer(texts, kept.code, key, kept.id(key))
        except NrsDesignError as error:
            stopped = isinstance(error, ClockError)
            code = exit_codes.INCONCLUSIVE if stopped else exit_codes.USAGE
            return PointAnswer(texts, code, error=error_summary(error))
        except Exception as error:
            # One point must not keep the others from being computed, whatever goes wrong with it.
            return PointAnswer(texts, exit_codes.INTERNAL, error=_defect(error))


def _holds(kept: CachedAnswer, shown: Mapping[str, Any]) -> bool:
    """Tell whether answer and exit code say no more than what was shown just now."""
    code = exit_codes.OF_VERDICT.get(str(shown.get("verdict")), kept.code)
    return kept.code == code and is_shown(kept.result, shown)


def _defect(error: Exception) -> dict[str, Any]:
    message = f"internal error: {type(error).__name__}: {error}"
    remedy = "a defect of nrs-design: write these values into the spec, and run nrs-design -v"
    fault = {"message": message, "line": None, "column": None, "remedy": remedy}
    return {"rule": None, "count": 1, "path": None, "faults": [fault]}


def _key(job: Job, axes: Sequence[LoadedSpec]) -> str:
    from nrs_design.gating.lock import hash_followed

    means: tuple[Data, ...] = tuple((axis.sha256, {**hash_followed(axis)}) for axis in axes)
    return key_of(means, job.asked, __version__)


def _shown(certificate: Path, axes: Sequence[LoadedSpec]) -> dict[str, Any]:
    """Return what a kept certificate shows, checked again against the spec of the point.

    Nothing, if it is not there, does not hold, or belongs to another spec.
    """
    if len(axes) != 1 or not certificate.is_file():
        return {}
    from nrs_design.certificates.verify import verify
    from nrs_design.facts.certification import shown_facts

    (loaded,) = axes
    with about(getattr(loaded.spec, "axis", None)):
        try:
            found = verify(certificate, loaded)
        except CertificateError:
            return {}
        if found.certificate is None or found.fault is not None:
            return {}
        # As JSON holds it, which has no tuples.
        facts: dict[str, Any] = json.loads(json.dumps(shown_facts(found.certificate, loaded.spec)))
    return facts


def _computed(job: Job, key: str) -> CachedAnswer:
    place = CERTIFYING.get(" ".join(job.command))
    placed = () if place is None else (place, str(job.store.certificate(key)))
    arguments = [*job.command, str(job.spec), *job.options, *placed, "--json", "--quiet"]
    with taking_json() as documents:
        code = _run(program_of(job.command[0]), arguments)
    return CachedAnswer(code, _lasting(json.loads(documents[-1])))


def _run(program: Any, arguments: list[str]) -> int:
    """Return the exit code of a command; who interrupts it interrupts the whole sweep."""
    import typer

    try:
        with program.make_context("nrs-design", arguments) as context:
            program.invoke(context)
    except typer.Exit as end:
        return end.exit_code
    return exit_codes.PROVED


@cache
def program_of(command: str) -> Any:
    """Return the program with one command; to make it takes longer than many a command."""
    import typer

    from nrs_design.cli.app import make_app

    return typer.main.get_command(make_app([command]))


def _lasting(document: Any) -> Any:
    """Return a document without what is not the same in every run."""
    if isinstance(document, dict):
        return {key: _lasting(value) for key, value in document.items() if key not in LEFT_OUT}
    return list(map(_lasting, document)) if isinstance(document, list) else document
