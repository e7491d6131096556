"""What ``import nrs_design as nrs`` offers."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from types import ModuleType

import nrs_design
from making.faults import refuse


def library_page(package: ModuleType = nrs_design) -> str:
    """List what the package offers; its docstrings are read where the page is built."""
    offered = {name: getattr(package, name) for name in package.__all__}
    refuse("public names without a docstring", undocumented(offered))
    lines = ["# Library", "", "`import nrs_design as nrs` offers:", ""]
    for name, thing in offered.items():
        # Where it is defined: what is documented by another name loses its parameters.
        lines += [f"::: {thing.__module__}.{name}", ""]
    return "\n".join(lines)


def undocumented(offered: dict[str, object]) -> Iterator[str]:
    """Yield the public names, and those of their public methods, that say nothing."""
    for name, thing in offered.items():
        if not (getattr(thing, "__doc__", None) or "").strip():
            yield name
        if inspect.isclass(thing):
            for key, member in vars(thing).items():
                member = getattr(member, "fget", None) or getattr(member, "__func__", member)
                if not key.startswith("_") and inspect.isfunction(member) and not member.__doc__:
                    yield f"{name}.{key}"
