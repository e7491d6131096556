"""The spec that a command is about."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from nrs_design.spec import LoadedSpec


def take_spec(path: Path) -> LoadedSpec:
    """Read a spec, and say everything until the end of the command about its axis."""
    from nrs_design.axis import take
    from nrs_design.spec import read_spec

    loaded = read_spec(path)
    take(getattr(loaded.spec, "axis", None))
    return loaded
