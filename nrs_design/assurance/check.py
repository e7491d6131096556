"""Check a folder of evidence: its hashes, its proof, and every page made again."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nrs_design import __version__
from nrs_design.assurance.case import Case, Given, UserFile, build_case
from nrs_design.assurance.contents import BUILD, FACTS, PARTS, RESULTS, contents_of
from nrs_design.assurance.folder import hash_faults, read_facts, read_folder
from nrs_design.assurance.sources import sources_of
from nrs_design.errors import CertificateError, NrsDesignError
from nrs_design.gating.judge import judge_result
from nrs_design.pipeline import Result, run_recorded
from nrs_design.progress import Progress, silent
from nrs_design.proof.text import quoted
from nrs_design.spec import LoadedSpec, read_spec

_PATH = "evidence.json names files or fields that it must not"


@dataclass(frozen=True, slots=True)
class FolderCheck:
    """What was found about a folder of evidence."""

    name: str  # Of the spec; empty if the folder does not say
    files: int  # How many there are
    faults: tuple[str, ...]  # Why it is rejected; empty if it is not
    undecided: str = ""  # Why pages were not made again; empty if they were
    notes: tuple[str, ...] = ()  # What a person should know beside it
    case: Case | None = None  # Made again; None if it was not

    @property
    def verdict(self) -> str:
        """``holds``, ``rejected``, or ``inconclusive`` if not all could be checked."""
        if self.faults:
            return "rejected"
        return "inconclusive" if self.undecided else "holds"


def check_evidence(
    folder: Path,
    spec: Path | None = None,
    binaries: Sequence[UserFile] = (),
    progress: Progress = silent,
) -> FolderCheck:
    """Check a folder.

    Parameters
    ----------
    folder : Path
        As `nrs_design.assurance.folder.write_folder` has written it.
    spec : Path, optional
        The spec as it is now: the folder must be about what it says.
    binaries : sequence of UserFile
        What runs now: the folder must name each by its hash.
    progress : callable
        Told the name of each step.

    Raises
    ------
    CertificateError
        If the folder cannot be read as evidence at all.
    SpecError
        If `spec` cannot be read.
    """
    progress("hashes")
    files = read_folder(folder)
    facts = read_facts(files)
    part = facts.get("spec")
    name = str(part.get("name", "")) if isinstance(part, dict) else ""
    faults = hash_faults(files)
    if faults:
        return FolderCheck(name, len(files), faults)
    try:
        loaded = read_spec(folder / _listed(facts, files, "spec"))
        faults = (*_of_now(loaded, spec), *_of_binaries(facts, binaries))
        proof = folder / _listed(facts, files, "certificate")
        result = run_recorded(loaded, proof, progress)
    except NrsDesignError as error:
        if spec is not None and error.path == spec:
            raise
        return FolderCheck(name, len(files), (str(error),))
    if result.certificate is None or result.certification.verdict != "proved":
        faults = (*faults, "its certificate proves nothing")
    if faults:
        return FolderCheck(name, len(files), faults)
    return _made_again(folder, files, facts, result, progress)


def _made_again(
    folder: Path,
    files: Mapping[str, bytes],
    facts: Mapping[str, Any],
    result: Result,
    progress: Progress,
) -> FolderCheck:
    """Make all files again from the spec, the certificate and what users gave."""
    name = result.loaded.spec.name
    try:
        release, decided = _text(facts, "package", "version"), _text(facts, "decides", "sha256")
    except CertificateError as error:
        return FolderCheck(name, len(files), (str(error),))
    if release != __version__:
        why = f"written by release {release}, and this is {__version__}: pages were not made again"
        return FolderCheck(name, len(files), (), why)
    results, build = (folder / name if name in files else None for name in (RESULTS, BUILD))
    try:
        named = tuple(UserFile(f["name"], f["size"], f["sha256"]) for f in facts["binaries"])
        given = Given(results, build, named, str(facts["date"] or ""))
        case = build_case(result, judge_result(result, progress), given, progress)
        again = contents_of(case, *sources_of(result.loaded))
    except (LookupError, TypeError):
        return FolderCheck(name, len(files), (_PATH,))
    except NrsDesignError as error:
        return FolderCheck(name, len(files), (str(error),))
    if case.decider.sha256 != decided:
        why = "written by other files of nrs_design/proof than are installed here"
        return FolderCheck(name, len(files), (), f"{why}: pages were not made again")
    # What is installed here may differ from what wrote the folder; hashes hold its list.
    notes = () if again[PARTS] == files[PARTS] else (f"{PARTS} lists other parts than are here",)
    faults = tuple(_unlike(files, again))
    return FolderCheck(name, len(files), faults, "", notes, case)


def _unlike(files: Mapping[str, bytes], again: Mapping[str, bytes]) -> Iterator[str]:
    for path in sorted(files.keys() | again.keys()):
        if path not in files:
            yield f"{path} is missing: spec and certificate give one"
        elif path not in again:
            yield f"{quoted(path)} is there, and spec and certificate give none"
        elif files[path] != again[path] and path not in (PARTS, "SHA256SUMS"):
            yield f"{path} is not what spec, certificate and results give"


def _of_now(loaded: LoadedSpec, spec: Path | None) -> Iterable[str]:
    if spec is not None and read_spec(spec).sha256 != loaded.sha256:
        yield f"{spec} says something else than the spec in the folder"


def _of_binaries(facts: Mapping[str, Any], binaries: Iterable[UserFile]) -> Iterable[str]:
    named = facts.get("binaries")
    listed = named if isinstance(named, list) else []
    hashes = {f.get("sha256") for f in listed if isinstance(f, dict)}
    for file in binaries:
        if file.sha256 not in hashes:
            yield f"{file.name} is none of the binaries that the folder names"


def _listed(facts: Mapping[str, Any], files: Mapping[str, bytes], part: str) -> str:
    """Return a path that the facts name, if it is one of the files."""
    path = _text(facts, part, "file")
    if path not in files:
        raise CertificateError(_PATH)
    return path


def _text(facts: Mapping[str, Any], part: str, key: str) -> str:
    inside = facts.get(part)
    found = inside.get(key) if isinstance(inside, dict) else None
    if not isinstance(found, str):
        raise CertificateError(f"{FACTS} does not say the {key} of its {part}")
    return found
