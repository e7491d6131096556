"""What in this program decides a verdict, from the files that are installed: facts, no praise."""

from __future__ import annotations

import ast
import hashlib
import sys
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import nrs_design
from nrs_design import proof

HOME = Path(nrs_design.__file__).parent
DECIDES = Path(proof.__file__).parent
# What is believed beside that, by what it does: its errors would be about another loop.
BELIEVED = {
    "reads the spec": ("spec",),
    "makes the modes of spec and gains": ("models", "controllers", "switched"),
    "reads certificates, and holds them against the spec": ("certificates",),
}
# How the last whole run over all mutants ended; absent before the first one.
MUTATION = Path(__file__).with_name("mutation.toml")


@dataclass(frozen=True, slots=True)
class SourceFile:
    """One file of what decides."""

    path: str  # From the folder of the package
    lines: int
    sha256: str


@dataclass(frozen=True, slots=True)
class MutationRecord:
    """How a run that made every small error in what decides ended; see `tests/mutation`."""

    sha256: str  # Of the files that were examined, as `Decider.sha256`
    mutants: int  # Small errors that were made
    killed: int  # Those that a test noticed
    equivalent: int  # Those that decide the same, each listed with its reason
    unnoticed: int  # Those that no test noticed


@dataclass(frozen=True, slots=True)
class Decider:
    """What decides whether something is proved."""

    release: str  # Of this program
    files: tuple[SourceFile, ...]
    imports: tuple[str, ...]  # Of other packages, beside the standard library
    believed: Mapping[str, int]  # Lines of what is believed beside it, by what that does
    mutation: MutationRecord | None  # None if this release ships no record

    @property
    def lines(self) -> int:
        """Number of lines of all files."""
        return sum(file.lines for file in self.files)

    @property
    def sha256(self) -> str:
        """Hash over the hashes of all files, in their order."""
        listed = "".join(f"{file.sha256}  {file.path}\n" for file in self.files)
        return hashlib.sha256(listed.encode()).hexdigest()

    @property
    def examined(self) -> bool:
        """Whether the mutation record is of these very files."""
        return self.mutation is not None and self.mutation.sha256 == self.sha256


def decider() -> Decider:
    """Read the files that decide, and the record of their mutants."""
    return Decider(nrs_design.__version__, *_installed(), _record())


@cache
def _installed() -> tuple[tuple[SourceFile, ...], tuple[str, ...], Mapping[str, int]]:
    """Return what decides, what it imports, and what is believed; no process sees it change."""
    sources = {path: path.read_bytes() for path in sorted(DECIDES.rglob("*.py"))}
    files = tuple(
        SourceFile(
            path.relative_to(HOME).as_posix(),
            source.count(b"\n"),
            hashlib.sha256(source).hexdigest(),
        )
        for path, source in sources.items()
    )
    imports = {name for source in sources.values() for name in _imported(source)}
    foreign = imports - sys.stdlib_module_names - {"nrs_design"}
    believed = {what: sum(map(_lines, folders)) for what, folders in BELIEVED.items()}
    return files, tuple(sorted(foreign)), believed


def keep_record(counts: Mapping[str, int]) -> None:
    """Keep how a run over all mutants of these files ended.

    Parameters
    ----------
    counts : mapping of str to int
        By the names of the fields of `MutationRecord`.
    """
    lines = [
        "# How the last whole run of `nox -s mutation` ended, and the hash of what it examined.",
        f'sha256 = "{decider().sha256}"',
        *(f"{name} = {counts[name]}" for name in ("mutants", "killed", "equivalent", "unnoticed")),
    ]
    MUTATION.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _record() -> MutationRecord | None:
    if not MUTATION.is_file():
        return None
    found: dict[str, Any] = tomllib.loads(MUTATION.read_text(encoding="utf-8"))
    return MutationRecord(**found)


def _lines(folder: str) -> int:
    return sum(path.read_bytes().count(b"\n") for path in (HOME / folder).rglob("*.py"))


def _imported(source: bytes) -> set[str]:
    """Return the packages that a source names in imports."""
    nodes = [*ast.walk(ast.parse(source))]
    named = {node.module or "" for node in nodes if isinstance(node, ast.ImportFrom)}
    named |= {a.name for node in nodes if isinstance(node, ast.Import) for a in node.names}
    return {name.partition(".")[0] for name in named}
