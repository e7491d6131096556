"""What several tests of searches share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import Candidates
from nrs_design.search.certify import first_accepted
from nrs_design.search.family import Family, floats_in_silence


def outcome(
    search: Callable[..., Candidates[Any]],
    system: SwitchedSystem,
    *,
    optimize_rate: bool = True,
    **options: Any,
) -> tuple[AbstractEvidence | None, str]:
    """Make one search as `certify` does, with the exact check, but let its errors pass."""
    with floats_in_silence():
        family = Family.of(system, optimize_rate=optimize_rate)
        return first_accepted(search(family, **options), system)


def found(
    search: Callable[..., Candidates[Any]], system: SwitchedSystem, **options: Any
) -> AbstractEvidence | None:
    """Return what the exact check accepts of a search."""
    return outcome(search, system, **options)[0]
