"""Kelvin-Voigt tissue, ``F = k delta + b ddelta`` (thesis 2.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, ClassVar

from nrs_design.models.contact.law import (
    DAMPING,
    STIFFNESS,
    AbstractLinearLaw,
    Element,
    Number,
    Reaction,
)
from nrs_design.models.linear_form import LinearForm, combine

if TYPE_CHECKING:
    from nrs_design.models.contact.motion import Array, Motion


@dataclass(frozen=True)
class KelvinVoigt(AbstractLinearLaw):
    """A spring beside a damper."""

    name: ClassVar[str] = "kelvin-voigt"
    formula: ClassVar[str] = "F = k δ + b δ'"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS, DAMPING)
    takes_velocity: ClassVar[bool] = True
    keys: ClassVar[tuple[str, ...]] = ("stiffness", "damping")
    may_vanish: ClassVar[frozenset[str]] = frozenset({"b"})
    front: ClassVar[str] = "k"

    k: Number  # Stiffness in N/m (N m/rad)
    b: Number  # Damping in N s/m (N m s/rad); may be zero

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivatives by log k and log b, shape (n, 2)."""
        import numpy as np

        return np.column_stack([float(self.k) * motion.deflection, float(self.b) * motion.velocity])

    @property
    def impedance(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """``(b s + k) / s``."""
        return (float(self.b), float(self.k)), (1.0, 0.0)

    def at_stiffness(self, value: Fraction) -> KelvinVoigt:
        """Return it with the same damping."""
        return KelvinVoigt(value, self.b)

    @property
    def is_spring(self) -> bool:
        """Whether there is no damping."""
        return self.b == 0

    @property
    def element(self) -> Element:
        """The spring and the damper beside it."""
        return Element(float(self.k), float(self.b))

    def react(self, velocity: LinearForm, states: Sequence[LinearForm]) -> Reaction:
        """Return ``F = k delta + b v`` and ``delta' = v``."""
        (k, b), (delta,) = self.exact, states
        return combine((k, delta), (b, velocity)), [velocity]
