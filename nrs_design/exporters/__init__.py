"""Designs for other programs; `formats` has a module for each format, and so have wings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

from nrs_design.errors import NrsDesignError
from nrs_design.wings import FORMATS, is_installed, load_wing

DESIGN = "a proof of the design"
SAMPLED = "a proof of the sampled loop, or --unproved"


@dataclass(frozen=True, slots=True)
class Format:
    """Purpose and files of a format."""

    purpose: str  # Use of the files, in a few words
    needs: str  # Condition for an export
    # Ending of each file, after the name of the spec, and its first bytes. A file with other first
    # bytes is not overwritten.
    files: Mapping[str, bytes]
    # True if a processor runs the files: the proof must be about the sampled loop.
    executable: bool = False
    # True if file names must be identifiers, such as `soft_tissue` for `soft-tissue`.
    identifier: bool = False
    # True if the format needs a certificate only, and no design.
    needs_proof_only: bool = False


@cache
def format_names() -> tuple[str, ...]:
    """Return the names of the formats of a design, with those of wings; none is loaded."""
    own_formats = (module.name for module in iter_modules([str(Path(__file__).parent / "formats")]))
    return tuple(
        sorted([*own_formats, *(name for name, wing in FORMATS.items() if is_installed(wing))])
    )


def format_of(name: str) -> Format:
    """Return a format by its name, one of `format_names`."""
    found: Format = _module(name).FORMAT
    return found


def known_format(name: str) -> Format:
    """Return a format by its name; an unknown name is a `NrsDesignError`."""
    if name not in {*format_names(), *FORMATS}:
        from nrs_design.spec.faults import did_you_mean

        raise NrsDesignError(
            f"there is no format {name!r}",
            remedy=f"{did_you_mean(name, format_names(), 'one of')}; `nrs-design export --list` "
            "explains them",
        )
    return format_of(name)


def rendered(name: str, export: object) -> dict[str, bytes]:
    """Return the contents of all files of a format, by what follows the name of the spec."""
    files: dict[str, bytes] = _module(name).render(export)
    return files


def find_remarks(name: str, files: Mapping[str, bytes]) -> tuple[str, ...]:
    """Return what rendered files lack."""
    return tuple(getattr(_module(name), "remarks", lambda _: ())(files))


def _module(name: str) -> Any:
    if name in FORMATS:
        return load_wing(FORMATS[name], "export")
    return import_module(f"{__name__}.formats.{name}")
