"""Wings of the package: their commands and formats, and access of the core to them.

A wing is a folder of the package. It imports the core; the core never imports a wing, but asks for
one here when it is needed. Without its folder, the rest works, and says what is missing.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from importlib.util import find_spec
from types import MappingProxyType, ModuleType

from nrs_design.errors import NrsDesignError

# The command NAME of a wing is `NAME` in the module `WING.cli.NAME`.
WINGS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "robot": ("robot",),
        "identification": ("identify", "audit"),
        "ros2": ("ros2",),
        "thesis": ("reproduce",),
        "coq": (),
    }
)
# Wings by the format of `nrs-design export` that each has: the module `WING.export`.
FORMATS: Mapping[str, str] = MappingProxyType({"coq": "coq"})


def wing_of(command: str) -> str | None:
    """Return the wing that has a command; None for those of the core."""
    return next((wing for wing, commands in WINGS.items() if command in commands), None)


def is_installed(wing: str) -> bool:
    """Return whether the package contains the folder of a wing; import nothing."""
    return find_spec(f"nrs_design.{wing}") is not None


def load_wing(wing: str, module: str) -> ModuleType:
    """Return a module of a wing, such as ``pipeline``; a wing may not be installed."""
    name = f"nrs_design.{wing}.{module}"
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        # A library that is not installed is another matter.
        if not f"{name}.".startswith(f"{error.name}."):
            raise
        raise NrsDesignError(
            f"the wing {wing} is not installed",
            remedy="install the whole of nrs-design: pip install --force-reinstall nrs-design",
        ) from None
