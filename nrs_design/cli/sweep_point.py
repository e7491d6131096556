"""One point of a sweep: a command, run in this process on a spec that says something else.

A point depends on what its spec means, on the command with its options, and on the version of this
program, and on nothing else. So an answer that is kept is used again, except for what it claims to
be proved: that is used only if the certificate beside it is checked again here, and shows the same.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from nrs_design import __version__
from nrs_design.axis import about
from nrs_design.cli import exit_codes
from nrs_design.cli.errors import error_summary
from nrs_design.cli.printing import taking_json
from nrs_design.errors import CertificateError, ClockError, NrsDesignError
from nrs_design.spec import LoadedSpec
from nrs_design.spec.document import Data, hash_meaning
from nrs_design.spec.edits import saying_instead
from nrs_design.spec.load import read_axes
from nrs_design.spec.task_space import file_of
from nrs_design.sweeps.answers import PointAnswer, is_shown
from nrs_design.sweeps.grid import Grid

CERTIFYING = ("certify-switching",)
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


def answer_point(job: Job, point: tuple[tuple[str, ...], PointAnswer | None]) -> PointAnswer:
    """Return what comes of some values: what is kept of it, if that holds, or what is computed."""
    values, kept = point
    with (
        saying_instead(file_of(job.spec), job.grid.changes(values)),
        TemporaryDirectory() as folder,
    ):
        place = Path(folder) / "point.cert.json"
        try:
            axes = read_axes(job.spec)
            key = _key(job, axes)
            if kept is not None and kept.key == key and _holds(job, kept, place, axes):
                return kept
            place.unlink(missing_ok=True)
            code, result = _computed(job, place)
            certificate = place.read_text(encoding="utf-8") if place.exists() else ""
            return PointAnswer(values, code, key, result, certificate)
        except NrsDesignError as error:
            stopped = isinstance(error, ClockError)
            code = exit_codes.INCONCLUSIVE if stopped else exit_codes.USAGE
            return PointAnswer(values, code, error=error_summary(error))
        except Exception as error:
            # One point must not keep the others from being computed, whatever goes wrong with it.
            message = f"internal error (a defect of nrs-design): {type(error).__name__}: {error}"
            summary = error_summary(NrsDesignError(message))
            return PointAnswer(values, exit_codes.INTERNAL, error=summary)


def _key(job: Job, axes: Sequence[LoadedSpec]) -> str:
    from nrs_design.gating.lock import hash_followed

    means: tuple[Data, ...] = tuple((axis.sha256, {**hash_followed(axis)}) for axis in axes)
    asked = (*job.command, *job.options)
    return hash_meaning({"spec": means, "asked": asked, "version": __version__})


def _holds(job: Job, kept: PointAnswer, place: Path, axes: Sequence[LoadedSpec]) -> bool:
    """Tell whether answer and exit code say no more than a certificate shows, checked again."""
    from nrs_design.api.proof_facts import shown_facts
    from nrs_design.certificates.verify import verify

    shown: dict[str, Any] = {}
    if kept.certificate and len(axes) == 1:
        (loaded,) = axes
        place.write_text(kept.certificate, encoding="utf-8")
        with about(getattr(loaded.spec, "axis", None)), suppress(CertificateError):
            found = verify(place, loaded)
            if found.certificate is not None and found.fault is None:
                # As JSON holds it, which has no tuples.
                shown = json.loads(json.dumps(shown_facts(found.certificate, loaded.spec)))
    # Where commands certify, no other code than that of a certificate, or inconclusive, is taken.
    unshown = exit_codes.INCONCLUSIVE if job.command == CERTIFYING else kept.code
    code = exit_codes.OF_VERDICT.get(str(shown.get("verdict")), unshown)
    known = kept.code in exit_codes.OF_SEVERITY and bool(kept.result)
    return known and kept.code == code and is_shown(kept.result or {}, shown)


def _computed(job: Job, place: Path) -> tuple[int, dict[str, Any]]:
    """Run the command; return its exit code and its document."""
    import typer

    placed = ("--out", str(place)) if job.command == CERTIFYING else ()
    arguments = [*job.command, str(job.spec), *job.options, *placed, "--json", "--quiet"]
    program, code = program_of(job.command[0]), exit_codes.PROVED
    with taking_json() as documents:
        try:
            with program.make_context("nrs-design", arguments) as context:
                program.invoke(context)
        except typer.Exit as end:
            code = end.exit_code
    return code, _lasting(json.loads(documents[-1]))


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
