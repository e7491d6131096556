"""A hand that holds the robot, ``F = k delta + b delta' + m delta''`` (thesis 7.2).

In an admittance with inertia the velocity vm is a state, so the acceleration of the robot follows
from the states at once, without the force. With the states xp of the motion loop,

    Mt vm' = -Bt vm + k delta + b Cp xp + m Cp (Ap xp - Bp vm),

which is affine in k, b and m, and with ranges of the motor in Km and 1/tau, each for itself:
corners suffice, for a mass too that changes as fast as it likes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

from nrs_design.errors import AssemblyError, DesignError
from nrs_design.models.contact.law import (
    DAMPING,
    MASS,
    STIFFNESS,
    AbstractMemorylessLaw,
    Element,
    Number,
    Reaction,
)
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.proof.assumption import Assumption


@dataclass(frozen=True)
class Hand(AbstractMemorylessLaw):
    """A spring, a damper and a mass that moves with the contact."""

    name: ClassVar[str] = "hand"
    sentences: ClassVar[Mapping[str, str]] = {
        "tissue.hand": (
            "{environment} holds the robot, and its mass moves with the "
            "contact: its force is k delta + b delta' + m delta''."
        ),
    }
    formula: ClassVar[str] = "F = k δ + b δ' + m δ''"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS, DAMPING, MASS)
    takes_velocity: ClassVar[bool] = True
    keys: ClassVar[tuple[str, ...]] = ("stiffness", "damping", "mass")
    may_vanish: ClassVar[frozenset[str]] = frozenset({"b", "m"})
    front: ClassVar[str] = "k"
    parallel_damping: ClassVar[str] = "b"
    has_mass: ClassVar[bool] = True

    k: Number  # Stiffness in N/m (N m/rad)
    b: Number  # Damping in N s/m (N m s/rad); may be zero
    m: Number  # Mass in kg (kg m^2); may be zero

    @property
    def is_spring(self) -> bool:
        """Whether there is neither damping nor mass."""
        return super().is_spring and self.m == 0

    @property
    def element(self) -> Element:
        """Refused: a run with a mass that moves along is not modelled."""
        raise DesignError(
            "a run in contact with a hand, which has a mass, is not modelled",
            remedy="simulate a kelvin-voigt environment with the same stiffness and damping",
        )

    @classmethod
    def assumptions(cls, environment: str, *, is_only: bool) -> Iterator[Assumption]:
        """Yield that its mass moves with the contact."""
        yield Assumption.create("tissue.hand", environment=environment)

    def react(self, velocity: LinearForm, states: Sequence[LinearForm]) -> Reaction:
        """Refuse to leave out the acceleration."""
        raise AssemblyError(
            "the force of a hand, which has a mass, is modelled for impedance controllers with a "
            "virtual inertia in deflection coordinates",
            remedy="use a kelvin-voigt environment, which has no mass",
        )

    def react_accelerated(
        self, velocity: LinearForm, acceleration: LinearForm, states: Sequence[LinearForm]
    ) -> Reaction:
        """Return ``F = k delta + b v + m v'`` and ``delta' = v``."""
        (k, b, m), (delta,) = self.exact, states
        return combine((k, delta), (b, velocity), (m, acceleration)), [velocity]
