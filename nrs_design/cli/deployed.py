"""What ``verify --deployed`` and ``--compile`` answer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nrs_design.certificates.certificate import Certificate
from nrs_design.cli.printing import progress, say
from nrs_design.exporters.binary import Binary, Toolchain, build_binary
from nrs_design.exporters.binary_record import binary_document, write_record
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.deployed import DeployedFiles, compare_deployed
from nrs_design.exporters.run_command import words_of
from nrs_design.spec import InteractionDesignSpec

# Of what a compiler or a self-test said, these many lines are shown: its end.
_SHOWN = 20


@dataclass(frozen=True, slots=True)
class DeployedAnswer:
    """What was deployed, and whether it is what the certificate is about."""

    place: Path
    comparison: DeployedFiles
    binary: Binary | None  # None where nothing was compiled
    record: dict[str, Any] | None  # Of a binary that passed
    file: Path | None  # Where it was written
    changed: tuple[str, ...]  # In what it differs from the record before

    @property
    def differences(self) -> tuple[str, ...]:
        """What is not as it must be, of files and of the binary."""
        fault = "" if self.binary is None else self.binary.fault
        return (*self.comparison.differences, *([fault] if fault else []))

    def show(self) -> None:
        """Print it, the worst first."""
        if self.differences:
            fault = f"{self.place} is not what the certificate is about"
            if not self.comparison.differences:
                fault = f"what is compiled of {self.place} is not shown to be the law"
            say(f"REJECTED: {fault}", verdict="rejected")
            for line in self.differences:
                say(f"  {line}")
        said = "" if self.binary is None else self.binary.said
        for line in said.splitlines()[-_SHOWN:]:
            say(f"    {line}")
        if not self.comparison.differences:
            self._show_compared()
        if self.record is not None:
            self._show_binary(self.record)

    def _show_compared(self) -> None:
        files, one = self.comparison.compared, not self.place.is_dir()
        what = str(self.place) if one else f"{len(files)} files of {self.place}"
        say(
            f"deployed: {what}: as exported with the certificate, bit for bit; not compared: "
            f"{self.comparison.left_out}"
        )

    def _show_binary(self, record: dict[str, Any]) -> None:
        say(f"binary: {record['result']}; {record['compiler']['version']}")
        for name, found in record["compiled"].items():
            say(f"  {name}: sha256 {found}")
        if self.changed:
            say(f"  changed since the record before: {', '.join(self.changed)}")
        say(f"  recorded in {self.file}, with what was not compared")


def deployed_answer(
    place: Path,
    lines: Mapping[str, str],
    spec: InteractionDesignSpec,
    certificate: Certificate,
) -> DeployedAnswer:
    """Compare what was deployed; compile and run it where lines say how.

    Parameters
    ----------
    place : Path
        A file, or a folder.
    lines : mapping of str to str
        Command lines by their options: none, or at least ``--compile``.
    spec : InteractionDesignSpec
        That of the certificate.
    certificate : Certificate
        Accepted.

    Raises
    ------
    NrsDesignError
        If a file cannot be read, or a command cannot be run or does not end.
    """
    words = {option: words_of(line, option) for option, line in lines.items()}
    comparison = compare_deployed(place, spec, certificate)
    if not words or comparison.differences:
        return DeployedAnswer(place, comparison, None, None, None, ())
    tools = Toolchain(words["--compile"], words.get("--link"), words.get("--run"))
    with progress(f"building {place.name}") as step:
        binary = build_binary(place, comparison.compared, CNames(spec.name), tools, step)
    if binary.fault:
        return DeployedAnswer(place, comparison, binary, None, None, ())
    record = binary_document(certificate, comparison, tools, binary)
    return DeployedAnswer(place, comparison, binary, record, *write_record(place, record))
