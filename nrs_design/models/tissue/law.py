"""What all tissue laws have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import astuple, dataclass, fields
from typing import ClassVar, Self

from nrs_design.models.tissue.motion import Array, Motion

STIFFNESS, DAMPING = "stiffness", "damping"


@dataclass(frozen=True)
class AbstractTissueLaw(ABC):
    """Reaction force of a tissue to its deflection; all parameters are positive.

    A law is written for a linear motion (m, N) and for a rotation about the pivot (rad, N m)
    alike; `at_pivot` converts from one to the other.
    """

    name: ClassVar[str]
    formula: ClassVar[str]
    # What each parameter is, in order: a stiffness, a damping, or something of the law's own.
    kinds: ClassVar[tuple[str, ...]]

    @abstractmethod
    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples, shape (n,), in N (N m), exactly discretized."""

    @abstractmethod
    def sensitivities(self, motion: Motion) -> Array:
        """Return the derivatives of `simulate` by the logarithms of the parameters, (n, p)."""

    @abstractmethod
    def at_pivot(self, radius: float) -> Self:
        """Return the law of the rotation, for a contact at this distance in m from the pivot."""

    @property
    def relaxation_time(self) -> float | None:
        """Time constant in s in which the force relaxes at rest; None if it does not."""
        return None

    @property
    def values(self) -> tuple[float, ...]:
        """The parameters in the order of `parameters`."""
        return astuple(self)

    @classmethod
    def parameters(cls) -> tuple[str, ...]:
        """Return the names of the parameters."""
        return tuple(field.name for field in fields(cls))
