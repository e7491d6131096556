"""Elastic tissue, ``F = k delta`` (thesis 2.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from nrs_design.models.contact.law import STIFFNESS, AbstractLinearLaw, Element, Number, Reaction
from nrs_design.models.linear_form import LinearForm, combine

if TYPE_CHECKING:
    from nrs_design.models.contact.motion import Array, Motion


@dataclass(frozen=True)
class Elastic(AbstractLinearLaw):
    """A spring."""

    name: ClassVar[str] = "elastic"
    formula: ClassVar[str] = "F = k δ"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS,)
    keys: ClassVar[tuple[str, ...]] = ("stiffness",)
    front: ClassVar[str] = "k"

    k: Number  # Stiffness in N/m (N m/rad)

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivative by log k, shape (n, 1)."""
        return float(self.k) * motion.deflection[:, None]

    @property
    def impedance(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """``k / s``."""
        return (0.0, float(self.k)), (1.0, 0.0)

    @property
    def element(self) -> Element:
        """The spring."""
        return Element(float(self.k))

    def react(self, velocity: LinearForm, states: Sequence[LinearForm]) -> Reaction:
        """Return ``F = k delta`` and ``delta' = v``."""
        (k,), (delta,) = self.exact, states
        return combine((k, delta)), [velocity]
