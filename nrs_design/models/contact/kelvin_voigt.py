"""Kelvin-Voigt tissue, ``F = k delta + b ddelta`` (thesis 2.5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from nrs_design.models.contact.law import DAMPING, STIFFNESS, AbstractMemorylessLaw, Number


@dataclass(frozen=True)
class KelvinVoigt(AbstractMemorylessLaw):
    """A spring beside a damper."""

    name: ClassVar[str] = "kelvin-voigt"
    formula: ClassVar[str] = "F = k δ + b δ'"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS, DAMPING)
    takes_velocity: ClassVar[bool] = True
    keys: ClassVar[tuple[str, ...]] = ("stiffness", "damping")
    may_vanish: ClassVar[frozenset[str]] = frozenset({"b"})
    front: ClassVar[str] = "k"
    parallel_damping: ClassVar[str] = "b"

    k: Number  # Stiffness in N/m (N m/rad)
    b: Number  # Damping in N s/m (N m s/rad); may be zero
