"""Rubber, whose damping grows with its stiffness: the file of a law that the package has not.

It is added to a copy of the package, as ``models/contact/rubber.py``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
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
from nrs_design.proof.assumption import Assumption

if TYPE_CHECKING:
    from nrs_design.models.contact.motion import Array, Motion


@dataclass(frozen=True)
class Rubber(AbstractLinearLaw):
    """``F = k (delta + h delta')`` as ``F = k delta + b delta'``, with b in proportion to k."""

    name: ClassVar[str] = "rubber"
    formula: ClassVar[str] = "F = k δ + b δ'"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS, DAMPING)
    takes_velocity: ClassVar[bool] = True
    keys: ClassVar[tuple[str, ...]] = ("stiffness", "damping")
    front: ClassVar[str] = "k"
    parallel_damping: ClassVar[str] = "b"
    sentences: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"tissue.rubber": "The damping of {environment} is in proportion to its stiffness."}
    )

    k: Number
    b: Number

    @classmethod
    def assumptions(cls, environment: str, *, is_only: bool) -> Iterator[Assumption]:
        """Yield that stiffness and damping go together."""
        yield Assumption.create("tissue.rubber", environment=environment)

    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples."""
        return float(self.k) * motion.deflection + float(self.b) * motion.velocity

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivatives by log k and log b."""
        import numpy as np

        return np.column_stack([float(self.k) * motion.deflection, float(self.b) * motion.velocity])

    @property
    def impedance(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """``(b s + k) / s``."""
        return (float(self.b), float(self.k)), (1.0, 0.0)

    @property
    def element(self) -> Element:
        """The spring and the damper beside it."""
        return Element(float(self.k), float(self.b))

    def react(self, velocity: LinearForm, states: Sequence[LinearForm]) -> Reaction:
        """Return the force, and ``delta' = v``."""
        (k, b), (delta,) = self.exact, states
        return combine((k, delta), (b, velocity)), [velocity]
