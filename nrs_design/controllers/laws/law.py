"""What all control laws have in common.

All gains are exact rationals that are single-precision numbers, so that a proof, a simulation
and an export speak about the same values.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from fractions import Fraction
from typing import ClassVar, Generic, Self, TypeVar

from nrs_design.controllers.sampled import SampledLaw
from nrs_design.models.linear_form import LinearForm
from nrs_design.spec.controllers import AbstractControllerSpec, Command

S = TypeVar("S", bound=AbstractControllerSpec)
# What a law gives the motion loop, and the rates of its states.
Response = tuple[LinearForm, list[LinearForm]]


@dataclass(frozen=True, slots=True)
class AbstractLaw(ABC):
    """A control law; its fields are its gains, exact single-precision numbers."""

    # As certificates and exports call it, and the unit of every gain.
    name: ClassVar[str]
    units: ClassVar[Mapping[str, str]]

    @property
    def gains(self) -> Mapping[str, Fraction]:
        """The gains by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def of(cls, gains: Mapping[str, Fraction]) -> Self:
        """Return the law with the gains of these names; others are left alone."""
        return cls(*(gains[field.name] for field in fields(cls)))


@dataclass(frozen=True, slots=True)
class AbstractCompliantLaw(AbstractLaw, Generic[S]):
    """A law that the robot switches to and from, over its motion loop.

    Its `name` is the `type` of its controllers in a spec.
    """

    # Whether the motion loop gets a velocity or a position from it.
    commands: ClassVar[Command]
    # Whether the velocity command of the hand waits while the law is active (thesis 6.3.3).
    holds_hand: ClassVar[bool] = False
    # Whether its one state stays in the position command of other controllers, and decays there.
    bleeds: ClassVar[bool] = False

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states of its own, with units; none by default."""
        return ()

    @property
    def state_words(self) -> tuple[str, ...]:
        """The states in words, such as ``the velocity vm``."""
        return self.states

    @property
    def inverse(self) -> frozenset[str]:
        """Gains in one over which `respond` is affine; it is affine in all others."""
        return frozenset()

    @property
    def spring(self) -> Fraction:
        """Stiffness in N m/rad that draws the robot back to its position reference; 0 is none.

        Times the offset that the law has given the reference, it adds to the force in `respond`.
        """
        return Fraction(0)

    @abstractmethod
    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return the command, and the rates of the states, as linear forms of the whole loop.

        Parameters
        ----------
        force : LinearForm
            Of all contacts on the robot and of the `spring`, N m.
        states : sequence of LinearForm
            Those named in `states`.
        """

    def sampled(self, period: Fraction, method: str) -> SampledLaw | None:
        """Return what a processor computes once a period in s, or None where that is not modelled.

        Raises
        ------
        DesignError
            If a coefficient is beyond single precision.
        """
        return None

    @classmethod
    def gains_in(cls, given: S) -> tuple[str, ...]:
        """Return the names of the gains that a controller of a spec has; by default all."""
        return tuple(cls.units)

    def find_fault(self, given: S) -> str | None:
        """Say which gain is not one that the spec allows, beyond bounds and ranges; or None.

        By default, a gain that the spec neither bounds nor ranges is not allowed: a law with gains
        that the spec gives in another way says here which ones those are.
        """
        free = next((gain for gain in self.gains if gain not in given.gains()), None)
        return None if free is None else f"gain {free} has no bounds in the spec"

    @classmethod
    @abstractmethod
    def contact_text(cls, *, alone: bool) -> str | None:
        """Say what is taken for granted about contact while it is active; None for nothing.

        Parameters
        ----------
        alone : bool
            Whether all controllers give the motion loop the same kind of command.
        """

    @property
    def retuned_text(self) -> str:
        """Say what the controller keeps while its gains change."""
        return "While a gain changes, the controller keeps its states."
