"""Frozen dataclasses that are made in a third of the time.

For each class, `dataclasses.dataclass` writes six functions as text and compiles them. Whoever
proves one thing starts a program for it, which makes half a hundred such classes, and that takes
longer than the proof. Here ``__init__`` alone is written for a class. To compare, hash and print is
one function for all, and what keeps a noun frozen is that each of its fields is set once.

What is loaded for every proof takes its ``dataclass`` from here, but for what the reference of the
library describes: that is read from the source, where only the standard decorator is known.
"""

from __future__ import annotations

from operator import attrgetter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    import dataclasses

    def dataclass(*, frozen, slots):
        """Do what `dataclasses.dataclass` does with ``frozen=True, slots=True``.

        Parameters
        ----------
        frozen, slots : bool
            True; written at each class, so that it says what it is.

        Returns
        -------
        callable
            Makes the dataclass of a class, which has fields to compare.

        Raises
        ------
        TypeError
            If one of them is not True.
        """
        if not (frozen and slots):
            raise TypeError("a noun is frozen, and has slots")
        return _made

    def _made(cls):
        made = dataclasses.dataclass(eq=False, repr=False, slots=True)(cls)
        compared = attrgetter(*(f.name for f in dataclasses.fields(made) if f.compare))

        def equals(self, other):
            if other.__class__ is not self.__class__:
                return NotImplemented
            return compared(self) == compared(other)

        def hashed(self):
            return hash(compared(self))

        methods = {"__eq__": equals, "__hash__": hashed, "__repr__": _printed}
        for name, method in methods.items():
            if name not in vars(cls):
                setattr(made, name, method)
        made.__setattr__, made.__delattr__ = _set_once, _keep
        return made

    def _printed(self):
        shown = (field.name for field in dataclasses.fields(self) if field.repr)
        fields = ", ".join(f"{name}={getattr(self, name)!r}" for name in shown)
        return f"{self.__class__.__qualname__}({fields})"

    def _set_once(self, name, value):
        if name not in self.__dataclass_fields__ or hasattr(self, name):
            raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
        object.__setattr__(self, name, value)

    def _keep(self, name):
        raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
