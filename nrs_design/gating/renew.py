"""Update ``nrs.lock`` with what the gate found; entries of other specs are kept."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from operator import attrgetter
from pathlib import Path

from nrs_design import __version__
from nrs_design.certificates.prove import read_document
from nrs_design.errors import CertificateError, OutputError
from nrs_design.gating.lock import (
    DECIDED_AGAIN,
    Lock,
    LockedCertificate,
    LockedRemark,
    LockedSpec,
    dump_lock,
    read_lock_if_any,
    relative_to_lock,
)
from nrs_design.gating.obligations import Caution, GateOutcome, SpecOutcome, Status
from nrs_design.output import LOCK, lock_folder, write_output
from nrs_design.pipeline.runs import Recorded
from nrs_design.spec.load import is_there


def make_lock(specs: Iterable[SpecOutcome], file: Path) -> Lock:
    """Return the lock of specs, for a lock file at a place.

    What makes no claim about switching is left out, and so is what has no verdict: a spec without
    an entry fails ``--locked``.
    """
    entries = [_entry(spec, file) for spec in specs if spec.verdict is not None]
    return Lock(specs=sorted(entries, key=lambda entry: entry.path))


def write_lock(outcome: GateOutcome, file: Path, *, prune: bool = False) -> GateOutcome:
    """Renew the entries of the specs that were examined, keep the others, and note it.

    A spec that has no verdict now keeps its entry if it has not changed: what was locked is
    re-checked exactly. `prune` drops the entries of specs that no longer exist.
    """
    for spec in outcome.specs:
        if spec.certificate is not None:
            check_folder(spec.certificate.parent, file)
    with lock_folder(file.parent):
        for spec in outcome.specs:
            _check_kept(spec)
        fresh = make_lock(outcome.specs, file).specs
        # A spec that is gone keeps its entry.
        present = (spec for spec in outcome.specs if is_there(spec.path))
        examined = {relative_to_lock(spec.path, file): spec for spec in present}
        locked = read_lock_if_any(file).specs
        # The entry of an unchanged spec still holds if the spec has no verdict now.
        still = {(p, s.sha256) for p, s in examined.items() if s.verdict is None}
        old = [e for e in locked if e.path not in examined or (e.path, e.sha256) in still]
        removed = {entry.path for entry in old if not is_there(file.parent / entry.path)}
        certificate_files = {
            entry.certificate.file for entry in fresh if entry.certificate is not None
        }
        # A spec that was renamed: its certificate is now found under the new name of the file.
        dropped = {
            e.path
            for e in old
            if e.certificate is not None and e.certificate.file in certificate_files
        }
        if prune:
            dropped |= removed
        old_entries = [entry for entry in old if entry.path not in dropped]
        if old_entries or fresh or file.exists():
            entries = sorted([*old_entries, *fresh], key=lambda entry: entry.path)
            if entries != locked or not file.exists():
                write_output(file, dump_lock(Lock(specs=entries)), replaces=LOCK)
                outcome = outcome.with_note(f"{file} written")
    pending = [s.path for s in outcome.specs if s.certifiable and s.verdict is None]
    names = {entry.path for entry in old_entries}
    missing = [str(path) for path in pending if relative_to_lock(path, file) not in names]
    unchanged = {str(path) for path in pending if is_there(path)}.difference(missing)
    for text, paths in (
        (f"not in {file}, for want of a verdict", missing),
        (f"without a verdict now, but unchanged, so still in {file}", unchanged),
        (f"removed from {file}", dropped),
        (f"no longer there, but in {file} (--prune removes it)", removed - dropped),
    ):
        if paths:
            outcome = outcome.with_note(f"{text}: {', '.join(sorted(paths))}")
    return outcome


def _check_kept(spec: SpecOutcome) -> None:
    """Refuse to lock a certificate that another run has replaced since it was written."""
    if spec.certificate is None:
        return
    with suppress(CertificateError):
        if read_document(spec.certificate).get("id") == spec.certificate_id:
            return
    raise OutputError(
        "is no longer the certificate that this run has written, so nothing is locked: another run "
        "works in this tree",
        path=spec.certificate,
        remedy="let it end, then run nrs-design gate again",
    )


# Ratio of an unbounded value to its limit.
_LARGEST_RATIO = 1e6
# A lock file proves nothing: a status without a certificate is locked as met or missed.
_LOCKED = {Status.PROVED: "met", Status.REFUTED: "missed"}


def recorded_in(lock: Lock, file: Path) -> Mapping[Path, Recorded]:
    """Return the certificate of every locked spec, by the absolute path of it."""
    return {
        Path(os.path.abspath(file.parent / entry.path)): Recorded(
            Path(os.path.normpath(file.parent / entry.certificate.file)), entry.certificate.id
        )
        for entry in lock.specs
        if entry.certificate is not None
    }


def check_folder(folder: Path, file: Path) -> None:
    """Refuse a folder for certificates that a lock file could not name."""
    if relative_to_lock(folder, file).partition("/")[0] == "..":
        raise OutputError(
            f"certificates must be below the folder of the lock file {file}",
            path=folder,
            remedy="choose another --reports or --lock",
        )


def _entry(spec: SpecOutcome, file: Path) -> LockedSpec:
    certificate = None
    if spec.certificate is not None and spec.certificate_id is not None:
        certificate = LockedCertificate(
            file=relative_to_lock(spec.certificate, file), id=spec.certificate_id
        )
    return LockedSpec.model_validate(
        {
            "path": relative_to_lock(spec.path, file),
            "sha256": spec.sha256,
            "version": __version__,
            "verdict": spec.verdict,
            "rate": spec.rate,
            "certificate": certificate,
            "gains": {name: dict(gains) for name, gains in spec.gains.items()},
            "goals": [
                {
                    "rule": item.rule.id,
                    "subject": item.subject,
                    "status": _LOCKED.get(item.status, str(item.status)),
                    "message": item.message,
                }
                for item in spec.obligations
                if item.rule not in DECIDED_AGAIN
            ],
            "remark": _remark(spec.cautions),
        }
    )


def _remark(cautions: Sequence[Caution]) -> LockedRemark | None:
    """Return the worst of what a design alone shows; JSON knows no infinity."""
    worst = max(cautions, key=attrgetter("beyond"), default=None)
    if worst is None or not worst.beyond:
        return None
    excess = float(f"{min(worst.beyond, _LARGEST_RATIO):.3g}")
    return LockedRemark(message=worst.message, at=[*map(str, worst.at)], beyond=excess)
