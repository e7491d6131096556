"""Which line of the spec a number comes from."""

from __future__ import annotations

import re

from nrs_design.certificates.catalogue import AssumptionKind
from nrs_design.reporting.document import Linked
from nrs_design.spec import InteractionDesignSpec, LoadedSpec, SwitchedSystemSpec

KeyPath = tuple[str | int, ...]


def linked(loaded: LoadedSpec, text: str, *at: str | int) -> str:
    """Return a text that leads to a line of the spec; without a place, or a text, as it is.

    What is not written out is led to where it would be.
    """
    is_declared = bool(at) and text not in ("", "–") and loaded.place(at[0]) != loaded.place()
    return Linked(text, loaded.place(*at).line) if is_declared else text


def locate_mode(loaded: LoadedSpec, mode: str) -> KeyPath:
    """Return the key path of a mode in its spec: of its matrix, or of its controller."""
    spec, first = loaded.spec, mode.split("/")[0]
    if isinstance(spec, SwitchedSystemSpec):
        names = [given.name for given in spec.modes]
        return ("modes", names.index(first)) if first in names else ("modes",)
    if isinstance(spec, InteractionDesignSpec) and first in spec.controllers:
        return ("controllers", first)
    return ()


def locate_contact(loaded: LoadedSpec, text: str) -> KeyPath:
    """Return the key path of the contact that a text names; empty if it names none."""
    spec = loaded.spec
    if not isinstance(spec, InteractionDesignSpec):
        return ()
    words = set(re.findall(r"[\w-]+", text))
    return next((("environments", name) for name in spec.environments if name in words), ())


def locate_assumption(kind: AssumptionKind) -> KeyPath:
    """Return the key path of the subject of an assumption; empty without one."""
    return tuple(kind.about.split(".")) if kind.about else ()
