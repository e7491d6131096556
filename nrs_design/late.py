"""Names that are imported when they are first used.

Whoever proves one thing starts a program for it, and loads it for longer than the proof takes. So
tables of kinds and of searches name what they hold, and a program loads what it comes to use.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def late_names(package: str, modules: Mapping[str, str]) -> Callable[[str], Any]:
    """Return the ``__getattr__`` of a package, for the names in each of its modules.

    `modules` has the names of a module as one text, with spaces between.
    """
    homes = {name: module for module, names in modules.items() for name in names.split()}

    def find(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(f"{package}.{homes[name]}"), name)

    return find


def late_function(module: str, name: str) -> Callable[..., Any]:
    """Return a function that is imported from its module when it is first called."""

    def call(*args: Any, **options: Any) -> Any:
        return getattr(import_module(module), name)(*args, **options)

    call.__name__ = name
    return call
