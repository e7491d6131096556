"""Whether what was deployed is what is exported with a certificate: bytes against bytes."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from nrs_design.certificates.certificate import Certificate
from nrs_design.controllers.gains import design_from_gains
from nrs_design.errors import NrsDesignError
from nrs_design.exporters import format_names, format_of, rendered
from nrs_design.exporters.build import build_record
from nrs_design.exporters.export import Export
from nrs_design.files import open_regular
from nrs_design.spec import InteractionDesignSpec

LARGEST_BYTES = 2**22
# First line of every exported file, and of the sources in a model for co-simulation.
_RELEASE = re.compile(rb"nrs-design (\d[\w.+]{0,40}), nrs-design/export/")
# The law and its monitor, not the self-test, which a robot may do without.
_LAW = re.compile(r"(?<!_test)\.[hc]$")
# How much of a line is shown, around the first byte that differs.
_BEFORE, _AFTER = 48, 32


@dataclass(frozen=True, slots=True)
class DeployedFiles:
    """Compared files of a deployment, and their differences."""

    compared: tuple[Path, ...]
    differences: tuple[str, ...]  # Each begins with the name of its file
    others: tuple[Path, ...]  # Other files of the folder

    @property
    def left_out(self) -> str:
        """Text on what was not compared."""
        return ", ".join(["how it is compiled", *(file.name for file in self.others)])


def compare_deployed(
    place: Path, spec: InteractionDesignSpec, certificate: Certificate
) -> DeployedFiles:
    """Compare a deployed file, or every exported file in a folder, with an accepted certificate.

    A file has the name that it was exported with; a folder holds at least header and source of the
    law. A `NrsDesignError` if a file cannot be read or compared, or the certificate does not cover
    it.
    """
    formats = {
        f"{spec.name}{end}": name
        for name in format_names()
        if format_of(name).executable
        for end in format_of(name).files
    }
    whole = place.is_dir()
    files = sorted(path for path in place.iterdir() if path.is_file()) if whole else [place]
    known = [file for file in files if file.name in formats]
    if not (whole or known):
        names = ", ".join(sorted({*formats.values()}))
        raise NrsDesignError(
            "is none of the files that are compared",
            path=place,
            remedy=f"name the folder, or a file of one of the formats {names}, under the name that "
            "it was exported with",
        )
    export = _export(spec, certificate, place)
    # A folder has the law itself, whatever else it has.
    there = {formats[file.name] for file in known} | ({"c"} if whole else set())
    exported = {
        f"{spec.name}{end}": content
        for name in sorted(there)
        for end, content in rendered(name, export).items()
    }
    told = [f"{file.name}: {each}" for file in known for each in _differs(file, exported)]
    if whole:
        missing = sorted(exported.keys() - {file.name for file in known})
        told += [f"{name}: it is missing" for name in missing if _LAW.search(name)]
    # The certificate is read, not compared.
    aside = {*known, place / f"{spec.name}.cert.json"}
    others = tuple(file for file in files if file not in aside)
    return DeployedFiles((*known,), (*told,), others)


def _export(spec: InteractionDesignSpec, certificate: Certificate, place: Path) -> Export:
    """Return what is exported with a certificate of a sampled loop."""
    if certificate.system.sample_time is None:
        raise NrsDesignError(
            "holds a law in steps, and the certificate is about continuous time",
            path=place,
            remedy="name a certificate of a spec with `sampling`",
        )
    if certificate.system.clock is not None and certificate.system.clock.is_round:
        raise NrsDesignError(
            "holds a law of one period, and the certificate is about two",
            path=place,
            remedy="name a certificate of a spec without `outer_period`",
        )
    design = design_from_gains(spec, certificate.gains)
    record = build_record(design, certificate, spec)
    return Export("proved", record, certificate, design=design, spec=spec)


def _differs(file: Path, exported: Mapping[str, bytes]) -> Iterator[str]:
    """Yield the first place in which a file differs, or the release that wrote it, if another."""
    found, wanted = _read(file), exported[file.name]
    if found == wanted:
        return
    ours, theirs = _release(wanted), _release(found)
    if theirs not in (ours, ""):
        yield (
            f"nrs-design {theirs} wrote it, and what {ours} writes has other bytes (compare it "
            f"with {theirs}, or export it again)"
        )
        return
    pairs = enumerate(zip(found, wanted, strict=False))
    at = next((k for k, (one, other) in pairs if one != other), min(len(found), len(wanted)))
    if b"\0" in wanted:
        yield (
            f"it differs from byte {at + 1} on (a library in it must be what the compiler here "
            "makes of its sources)"
        )
        return
    line = wanted.count(b"\n", 0, at) + 1
    has, should = _around(found, at), _around(wanted, at)
    yield f"line {line}: it has {has}, and the export has {should}"


def _release(content: bytes) -> str:
    """Return the release that wrote a file, as it says; empty if it says none."""
    found = _RELEASE.search(content)
    return "" if found is None else found[1].decode()


def _around(content: bytes, at: int) -> str:
    """Return a line as far as it is near a byte, quoted: a line break or an escape is seen."""
    start = max(content.rfind(b"\n", 0, at) + 1, at - _BEFORE)
    end = content.find(b"\n", at)
    line = content[start : min(end if end >= 0 else len(content), at + _AFTER)]
    return repr(line.decode("ascii", "backslashreplace")) if line else "nothing"


def _read(file: Path) -> bytes:
    try:
        with open_regular(file) as stream:
            content = stream.read(LARGEST_BYTES + 1)
    except OSError as error:
        raise NrsDesignError(f"cannot be read ({error.strerror})", path=file) from error
    if len(content) > LARGEST_BYTES:
        raise NrsDesignError("is larger than any export", path=file, remedy="export it again")
    return content
