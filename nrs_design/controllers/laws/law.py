"""The interface of control laws.

All gains are exact rationals that are single-precision numbers, so that a proof, a simulation
and an export speak about the same values. A law is a list of operations with numbers
(`AbstractCompliantLaw.parts`, `AbstractCompliantLaw.discretize`), and beside it the limit for short
periods (`AbstractCompliantLaw.respond`).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from fractions import Fraction
from typing import Any, ClassVar, Generic, Self, TypeVar

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.parts import PROPORTIONAL, StepPart
from nrs_design.models.linear_form import LinearForm
from nrs_design.spec.controllers import AbstractControllerSpec, Command
from nrs_design.spec.quantity import exact_number

S = TypeVar("S", bound=AbstractControllerSpec)
# Command of a law to the motion loop, and rates of the states.
Response = tuple[LinearForm, list[LinearForm]]


@dataclass(frozen=True, slots=True)
class AbstractLaw(ABC):
    """A control law; its fields are its gains, exact single-precision numbers.

    A field with a default is a gain only where it has another value.
    """

    # Name in certificates and exports, and unit of every gain.
    name: ClassVar[str]
    units: ClassVar[Mapping[str, str]]

    @property
    def gains(self) -> Mapping[str, Fraction]:
        """The gains by name."""
        numbers = ((field, getattr(self, field.name)) for field in fields(self))
        return {field.name: number for field, number in numbers if number != field.default}

    @classmethod
    def create(cls, gains: Mapping[str, Fraction]) -> Self:
        """Return the law with the gains of these names; others are left alone."""
        needed = (f.name for f in fields(cls) if f.name in gains or f.default is MISSING)
        return cls(**{name: gains[name] for name in needed})


@dataclass(frozen=True, slots=True)
class AbstractCompliantLaw(AbstractLaw, Generic[S]):
    """A law that the robot switches to and from, over its motion loop.

    Its `name` is the `type` of its controllers in a spec.
    """

    # Kind of command for the motion loop: velocity or position.
    commands: ClassVar[Command]
    # An active law may let the velocity command of the hand wait (thesis 6.3.3).
    holds_hand: ClassVar[bool] = False
    # Gains that a spec may fix, and the fields of the controller that do.
    fixed: ClassVar[Mapping[str, str]] = {}
    # Id of an assumption on its own computation by a processor.
    sampled: ClassVar[str | None] = None
    # Sentences about this law alone, by the ids of assumptions.
    sentences: ClassVar[Mapping[str, str]] = {}
    # The state may decay in the position command of other controllers.
    is_leaky: ClassVar[bool] = False
    # Id of the assumption on contact under this law, for designs with velocity and position
    # commands. Default: contact is never lost. None: no assumption.
    contact_kept: ClassVar[str | None] = "never"

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states of its own, with units; none by default."""
        return ()

    @property
    def spring(self) -> Fraction:
        """Stiffness in N m/rad towards the position reference; zero for none.

        Times the offset that the law has given the reference, it adds to the force in `respond`.
        """
        return Fraction(0)

    @abstractmethod
    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return the command and the rates of the `states` as linear forms of the loop state.

        The force is that of all contacts on the robot and of the `spring`, in N m.
        """

    @abstractmethod
    def discretize(self, period: Fraction, method: str) -> DiscreteLaw:
        """Return the numbers that a processor holds, for a period in s.

        The method, for the states of the law, is ``exact`` or ``euler``. A coefficient beyond
        single precision is a `DesignError`.
        """

    @classmethod
    def parts(cls, number_names: Collection[str], *, has_position: bool) -> tuple[StepPart, ...]:
        """Return the operations of the law: by default, those of a position controller.

        `used` are the names of the numbers that laws of the program have; `beside`: some
        controllers of the program are given a position.
        """
        return (PROPORTIONAL,)

    @classmethod
    def gain_names(cls, spec: S) -> tuple[str, ...]:
        """Return the names of the gains that a controller of a spec has; by default all."""
        return tuple(cls.units)

    def find_fault(self, spec: S) -> str | None:
        """Return the fault of a gain that the spec does not allow, beyond bounds and ranges.

        The spec may give the gains of `fixed`, and bounds all others.
        """
        for gain, value in self.gains.items():
            if gain in self.fixed:
                fixed_value = getattr(spec, self.fixed[gain])
                if fixed_value is not None and value != round_float32(exact_number(fixed_value)):
                    return f"gain {gain} is not what the spec fixes"
            elif gain not in spec.gains():
                return f"gain {gain} has no bounds in the spec"
        return None


# Any law: the type of its spec follows from the controller.
CompliantLaw = AbstractCompliantLaw[Any]


@dataclass(frozen=True, slots=True)
class DiscreteLaw:
    """A law as a processor computes it once a period: its operations, with their numbers."""

    law: type[CompliantLaw]
    # Single-precision numbers by the names of `StepGain`; those that are missing are zero.
    numbers: Mapping[str, Fraction]

    def __hash__(self) -> int:
        """Return the same number for equal laws."""
        return hash((self.law, *self.numbers.items()))

    @property
    def coefficients(self) -> dict[str, Fraction]:
        """The numbers by the symbols that formulas have for them."""
        parts = self.law.parts(self.numbers, has_position=False)
        symbols = {gain.name: gain.symbol for part in parts for gain in part.gains}
        return {symbols[name]: number for name, number in self.numbers.items()}
