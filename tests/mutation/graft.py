"""Give the functions of an imported module the code of a changed one."""

from __future__ import annotations

from fractions import Fraction
from types import CodeType, FunctionType, ModuleType
from typing import Any


def graft(module: ModuleType, code: CodeType) -> None:
    """Replace the code of every function and method, and the constants, of a module.

    Whoever has imported a function has the same object, so nothing needs to be imported again.
    """
    changed: dict[str, Any] = {**vars(module), "__annotations__": {}}
    exec(code, changed)
    _graft_names(vars(module), changed, module)


def _graft_names(names: Any, changed: Any, owner: Any) -> None:
    for name, old in list(names.items()):
        new = changed.get(name)
        if isinstance(old, type) and isinstance(new, type) and old is not new:
            if old.__module__ == new.__module__:
                _graft_names(vars(old), vars(new), old)
        elif functions := _functions(old):
            for target, source in zip(functions, _functions(new), strict=True):
                target.__code__, target.__defaults__ = source.__code__, source.__defaults__
                target.__kwdefaults__ = source.__kwdefaults__
        elif isinstance(old, (int, tuple, Fraction)) and new != old:
            setattr(owner, name, new)


def _functions(thing: Any) -> list[FunctionType]:
    """Return what runs when a name is called or read, behind decorators of the standard library."""
    if isinstance(thing, property):
        return _functions(thing.fget)
    thing = getattr(thing, "__func__", thing)
    thing = getattr(thing, "__wrapped__", thing)
    return [thing] if isinstance(thing, FunctionType) else []
