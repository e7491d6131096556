"""Errors of the print and gaps in it, as data: each once, whatever rows it touches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any


@dataclass(frozen=True, slots=True)
class Erratum:
    """One error or gap of the print."""

    id: str  # Short name, which rows use
    where: str  # Sections, equations or tables
    about: str  # What it is


@cache
def errata() -> tuple[Erratum, ...]:
    """Return all of them, in the order of the thesis."""
    return tuple(Erratum(**entry) for entry in read_data("errata.yaml"))


@cache
def read_data(name: str) -> Any:
    """Return what a data file of this package holds."""
    from ruamel.yaml import YAML

    text = files("nrs_design.thesis").joinpath(name).read_text(encoding="utf-8")
    return YAML(typ="safe", pure=True).load(text)
