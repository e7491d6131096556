"""Comparison of deployed files with the export of a certificate, byte for byte."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import zip_longest
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
# Characters of a line that a message shows.
_MAX_CHARACTERS = 100


@dataclass(frozen=True, slots=True)
class DeployedFiles:
    """Compared files of a deployment, and their differences."""

    compared: tuple[Path, ...]
    differences: tuple[str, ...]  # Each begins with the name of its file
    unchecked_files: tuple[Path, ...]  # Other files in the folder and below it, relative to it

    @property
    def left_out(self) -> str:
        """Text on what was not compared."""
        return ", ".join(
            ["how it is compiled", *(file.as_posix() for file in self.unchecked_files)]
        )


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
    files = sorted(path for path in place.rglob("*") if path.is_file()) if whole else [place]
    known = [file for file in files if file.name in formats and (file.parent == place or not whole)]
    if not (whole or known):
        names = ", ".join(sorted({*formats.values()}))
        raise NrsDesignError(
            "is none of the files that are compared",
            path=place,
            remedy=f"name the folder, or a file of one of the formats {names}, under the name that "
            "it was exported with",
        )
    export = _export(spec, certificate, place)
    # A folder must hold the law itself.
    format_kinds = {formats[file.name] for file in known} | ({"c"} if whole else set())
    exported = {
        f"{spec.name}{end}": content
        for name in sorted(format_kinds)
        for end, content in rendered(name, export).items()
    }
    differences = [
        f"{file.name}: {difference}" for file in known for difference in _differs(file, exported)
    ]
    if whole:
        missing = sorted(exported.keys() - {file.name for file in known})
        differences += [f"{name}: it is missing" for name in missing if _LAW.search(name)]
    # The certificate is read, not compared.
    accounted_files = {*known, place / f"{spec.name}.cert.json"}
    others = dict.fromkeys(
        _visible(file.relative_to(place)) for file in files if file not in accounted_files
    )
    return DeployedFiles((*known,), (*differences,), (*others,))


def _visible(file: Path) -> Path:
    """Return a path, cut after its first hidden folder."""
    hidden = (k for k, part in enumerate(file.parts[:-1], 1) if part.startswith("."))
    return Path(*file.parts[: next(hidden, None)])


def _export(spec: InteractionDesignSpec, certificate: Certificate, place: Path) -> Export:
    """Return what is exported with a certificate of a sampled loop."""
    system = certificate.system
    if system.sample_time is None or (system.clock is not None and system.clock.is_round):
        timing = "continuous time" if system.sample_time is None else "two periods"
        raise NrsDesignError(
            f"holds a law in steps of one period, and the certificate is about {timing}",
            path=place,
            remedy="name a certificate of a spec with `sampling`, and without `outer_period`",
        )
    design = design_from_gains(spec, certificate.gains)
    record = build_record(design, certificate, spec)
    return Export("proved", record, certificate, design=design, spec=spec)


def _differs(file: Path, exported: Mapping[str, bytes]) -> Iterator[str]:
    """Yield the first place in which a file differs, or the release that wrote it, if another."""
    found, expected = _read(file), exported[file.name]
    if found == expected:
        return
    own_release, file_release = _release(expected), _release(found)
    if file_release not in (own_release, ""):
        yield (
            f"nrs-design {file_release} wrote it, and what {own_release} writes has other bytes "
            f"(compare it with {file_release}, or export it again)"
        )
        return
    if b"\0" in expected:
        yield "it differs (a library in it must be what the compiler here makes of its sources)"
        return
    pairs = zip_longest(found.split(b"\n"), expected.split(b"\n"), fillvalue=b"(end of the file)")
    number, differing = next((n, pair) for n, pair in enumerate(pairs, 1) if pair[0] != pair[1])
    # Quoted: a line break or an escape is seen.
    has, should = (
        repr(line[:_MAX_CHARACTERS].decode("ascii", "backslashreplace")) for line in differing
    )
    yield f"line {number}: it has {has}, and the export has {should}"


def _release(content: bytes) -> str:
    """Return the release that wrote a file, as it says; empty if it says none."""
    found = _RELEASE.search(content)
    return "" if found is None else found[1].decode()


def _read(file: Path) -> bytes:
    try:
        with open_regular(file) as stream:
            content = stream.read(LARGEST_BYTES + 1)
    except OSError as error:
        raise NrsDesignError(f"cannot be read ({error.strerror})", path=file) from error
    if len(content) > LARGEST_BYTES:
        raise NrsDesignError("is larger than any export", path=file, remedy="export it again")
    return content
