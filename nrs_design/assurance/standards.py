"""Which clause of which standard each file of a folder can support; a help, no claim."""

from __future__ import annotations

import tomllib
from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

_TABLE = Path(__file__).with_name("standards.toml")
NOTHING = "nothing in this folder"


@dataclass(frozen=True, slots=True)
class Clause:
    """One clause, and what can support it."""

    clause: str  # Number and subject
    files: tuple[str, ...]  # Of the folder; ``NAME`` stands for that of the spec
    can: str  # What they can support
    user: str  # What is left for the maker of the device
    program: bool = False  # Whether it takes an exported program


@dataclass(frozen=True, slots=True)
class Standard:
    """One standard with the clauses that are named."""

    name: str
    about: str
    row: tuple[Clause, ...]


@cache
def standards() -> tuple[Standard, ...]:
    """Return the table."""
    table: list[dict[str, Any]] = tomllib.loads(_TABLE.read_text(encoding="utf-8"))["standard"]
    return tuple(
        Standard(one["name"], one["about"], tuple(map(_clause, one["row"]))) for one in table
    )


def support_of(clause: Clause, name: str, files: Collection[str]) -> str:
    """Return the files of a folder that can support a clause, in words.

    Parameters
    ----------
    clause : Clause
        Of the table.
    name : str
        Of the spec.
    files : collection of str
        Paths in the folder.
    """
    wanted = [file.replace("NAME", name) for file in clause.files]
    there = [file for file in wanted if any(each.startswith(file) for each in files)]
    short = clause.program and "program/" not in there
    return ", ".join(there) if there and not short else NOTHING


def _clause(row: dict[str, Any]) -> Clause:
    return Clause(**{**row, "files": tuple(row["files"])})
