"""Elastic tissue, ``F = k delta`` (thesis 2.5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from nrs_design.models.contact.law import STIFFNESS, AbstractMemorylessLaw, Number


@dataclass(frozen=True)
class Elastic(AbstractMemorylessLaw):
    """A spring."""

    name: ClassVar[str] = "elastic"
    formula: ClassVar[str] = "F = k δ"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS,)
    keys: ClassVar[tuple[str, ...]] = ("stiffness",)
    front: ClassVar[str] = "k"

    k: Number  # Stiffness in N/m (N m/rad)
