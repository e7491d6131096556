"""Weaker requirements than in a base folder, such as a checkout of the branch to merge into.

The gate proves what specs ask for, so a spec that asks for less passes more easily. The base has
the same paths; it is only read.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path

from nrs_design import __version__
from nrs_design.certificates.certificate import Certificate, Verdict
from nrs_design.certificates.goals import rate_per_second
from nrs_design.certificates.prove import (
    Verification,
    held_system,
    judged,
    read_certificate,
    read_document,
)
from nrs_design.errors import NrsDesignError
from nrs_design.gating.find_specs import find_specs
from nrs_design.gating.lock import LockedSpec, read_lock_if_any
from nrs_design.gating.obligations import (
    BaseChanges,
    Caution,
    GateOutcome,
    Obligation,
    SpecOutcome,
    Status,
)
from nrs_design.gating.rules import NOT_WEAKER
from nrs_design.proof.bounds import lower, upper
from nrs_design.spec import read_spec
from nrs_design.spec.load import is_there
from nrs_design.spec.spec_weakening import Change, find_changes
from nrs_design.spec.task_space import file_of

_REMOVED = "this spec of the base is gone: what it asked for is no longer shown"
# Verdicts, from the one that shows most.
_VERDICTS = ("proved", "inconclusive", "refuted")


def base_paths(paths: Sequence[Path], base: Path) -> tuple[Path, ...]:
    """Return the places of these paths in the base, as far as they exist there."""
    if not base.is_dir():
        remedy = "name a checkout of the base branch"
        raise NrsDesignError("is not a folder", path=base, remedy=remedy)
    if os.path.realpath(base) == os.path.realpath("."):
        raise NrsDesignError("is this folder itself", path=base, remedy="name another checkout")
    relative = [Path(os.path.relpath(path)) for path in paths]
    folder = os.path.realpath(".")
    for path in relative:
        if path.parts[:1] == ("..",) or path.is_absolute():
            raise NrsDesignError(
                "is not below the working folder, so its place in the base is not known",
                path=path,
                remedy="run the command where the paths begin in both folders",
            )
        # A link to the base would compare the base with itself.
        if os.path.commonpath([folder, os.path.realpath(path)]) != folder:
            raise NrsDesignError(
                "is a link that leads out of the working folder",
                path=path,
                remedy="name what is compared itself, or remove the link",
            )
    return tuple(base / path for path in relative if os.path.lexists(file_of(base / path)))


def compare_with_base(
    outcome: GateOutcome, paths: Sequence[Path], base: Path, lock: Path
) -> GateOutcome:
    """Add a broken obligation for each weaker requirement, and list all other changes."""
    base_specs = _specs_if_any(base_paths(paths, base))
    # By path from the root of the base.
    folder = Path(os.path.relpath(lock)).parent
    locked = read_lock_if_any(base / os.path.relpath(lock)).specs
    entries = {os.path.normpath(folder / entry.path): entry for entry in locked}
    here = {Path(os.path.relpath(spec.path)): spec for spec in outcome.specs}
    found: dict[Path, list[Change]] = {}
    removed: list[SpecOutcome] = []
    for path in base_specs:
        name = Path(os.path.relpath(path, base))
        now = here.get(name) or _find_moved(path, base_specs, base, outcome)
        if now is None:
            missed = Obligation(NOT_WEAKER, name, "spec", Status.MISSED, _REMOVED)
            removed.append(SpecOutcome(name, (missed,)))
            continue
        entry = entries.get(os.path.normpath(name))
        if os.path.lexists(now.path) or is_there(now.path):
            found[now.path] = [
                *_compare_spec(path, now),
                *_compare_lock(entry, now, (base / lock).parent),
            ]
        else:
            # The spec is gone, but the lock file here still names it.
            found[now.path] = [Change((), _REMOVED, True)]
    specs = [_add_changes(spec, found.get(spec.path, ())) for spec in outcome.specs]
    weaker = sum(change.weaker for changes in found.values() for change in changes) + len(removed)
    others = tuple(
        _caution(spec, change)
        for spec in outcome.specs
        for change in found.get(spec.path, ())
        if not change.weaker
    )
    return replace(outcome, specs=(*specs, *removed), changes=BaseChanges(base, weaker, others))


def _specs_if_any(paths: Sequence[Path]) -> tuple[Path, ...]:
    """List the specs of files and folders; a folder may have none."""
    found: list[Path] = []
    for path in paths:
        try:
            found += find_specs([path])
        except NrsDesignError as error:
            # A folder without specs raises the base class; unreadable files raise a subclass.
            if type(error) is not NrsDesignError:
                raise
    return tuple(dict.fromkeys(found))


def _find_moved(
    path: Path, base_specs: Sequence[Path], base: Path, outcome: GateOutcome
) -> SpecOutcome | None:
    """Return the spec here that has the name of one of the base, but a new path."""
    known = {os.path.normpath(os.path.relpath(other, base)) for other in base_specs}
    name = _name_of(path)
    for spec in outcome.specs:
        new = os.path.normpath(os.path.relpath(spec.path)) not in known
        if new and name is not None and name == _name_of(spec.path):
            return spec
    return None


def _name_of(path: Path) -> str | None:
    try:
        return read_spec(path).spec.name
    except NrsDesignError:
        return None


def _compare_spec(path: Path, now: SpecOutcome) -> Iterator[Change]:
    """Yield the differences between the spec of the base and the spec here."""
    try:
        after = read_spec(now.path)
    except NrsDesignError:
        # Said already, as what is wrong with this spec.
        return
    try:
        before = read_spec(path)
    except NrsDesignError as error:
        yield Change((), f"cannot be compared: that of the base cannot be read ({error})", True)
        return
    yield from find_changes(before.spec, after.spec)


def _compare_lock(entry: LockedSpec | None, now: SpecOutcome, folder: Path) -> Iterator[Change]:
    """Yield a lower verdict or a proof of less than the base has locked, and another version."""
    if entry is None:
        if now.certifiable:
            yield Change((), "the base has locked no verdict and no proof to compare with", False)
        return
    if now.verdict is None or _VERDICTS.index(now.verdict) > _VERDICTS.index(entry.verdict):
        yield Change((), f"{entry.verdict} before, {now.verdict or 'without a verdict'} now", True)
    elif entry.certificate is not None and now.certificate is not None:
        yield from _compare_proof(folder / entry.certificate.file, now.certificate)
    if entry.version != __version__:
        message = f"designed by nrs-design {entry.version} before, {__version__} now"
        yield Change((), message, False)


def _compare_proof(before: Path, after: Path) -> Iterator[Change]:
    """Yield the differences between two certificates; a lost statement is weaker.

    That of the base is only read: whoever made it has checked it.
    """
    base = judged(partial(_read, before))
    if base.fault is not None:
        message = f"the certificate of the base cannot be compared: {base.fault}"
        yield Change((), message, True)
        return
    was, now = (
        dict(_list_claims(one.certificate)) for one in (base, judged(partial(_read, after)))
    )
    for claim in dict.fromkeys((*was, *now)):
        number, text = was.get(claim, (None, "not shown"))
        other, said = now.get(claim, (None, "not shown"))
        if text != said:
            weaker = number is not None and (other is None or other < number)
            yield Change((), f"{claim} {text} before, {said} now", weaker)


def _read(file: Path) -> Verification:
    document = read_document(file)
    return Verification(read_certificate(document, held_system(document)), None)


def _list_claims(certificate: Certificate | None) -> Iterator[tuple[str, tuple[Fraction, str]]]:
    """Yield name, number and text of each proved fact; a larger number is a stronger fact."""
    if certificate is None:
        return
    system, evidence = certificate.system, certificate.evidence
    if evidence is not None and certificate.verdict == Verdict.PROVED:
        rate = evidence.proved_rate(system)
        seconds = rate_per_second(rate, system)
        if seconds is not None:
            yield "certified rate", (seconds, lower(seconds))
        elif rate is not None:
            yield "certified rate per step", (-rate, upper(rate))
        for what, is_covered in (
            ("loss of contact", evidence.covers_lost_contact),
            ("rounding", evidence.covers_rounding),
        ):
            if is_covered:
                yield what, (Fraction(1), "covered")
    for item in certificate.statements:
        if (bound := item.bound(system)) is not None:
            channels = ", ".join(channel.name for channel in bound.channels)
            rounding = ", with rounding" * item.covers_rounding
            what = f"bound on {bound.output.name} under {channels}{rounding}"
            yield what, (-bound.level, upper(bound.level))
        if (size := item.start_size) is not None:
            yield "decay although signals saturate, from", (size, lower(size))


def _add_changes(spec: SpecOutcome, changes: Sequence[Change]) -> SpecOutcome:
    """Return a spec with an obligation for each thing that is weaker, at its place."""
    broken = []
    for change in (change for change in changes if change.weaker):
        caution, where = _caution(spec, change), ".".join(map(str, change.key_path)) or "spec"
        place = (caution.message, caution.line, caution.column)
        broken.append(Obligation(NOT_WEAKER, spec.path, where, Status.MISSED, *place))
    return replace(spec, obligations=(*spec.obligations, *broken))


def _caution(spec: SpecOutcome, change: Change) -> Caution:
    try:
        place = read_spec(spec.path).place(*change.key_path)
    except NrsDesignError:
        return Caution(spec.path, change.message, 1, 1)
    return Caution(spec.path, change.message, place.line, place.column)
