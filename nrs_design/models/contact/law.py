"""The interface of contact laws.

NumPy is imported where it is used: a certificate is verified without it.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, fields, replace
from fractions import Fraction
from typing import TYPE_CHECKING, ClassVar, Self

from nrs_design.errors import AssemblyError
from nrs_design.models.interval import turn
from nrs_design.models.linear_form import ONE, ZERO, LinearForm, combine, coordinates, zero
from nrs_design.proof.assumption import Assumption

if TYPE_CHECKING:
    from nrs_design.models.contact.motion import Motion
    from nrs_design.models.contact.relaxation import Array

STIFFNESS, DAMPING, MASS = "stiffness", "damping", "mass"
# Units of a linear motion and of a rotation about the pivot.
_UNITS = {
    STIFFNESS: ("N/m", "N*m/rad"),
    DAMPING: ("N*s/m", "N*m*s/rad"),
    MASS: ("kg", "kg*m^2"),
}

# A measured or designed value, or an exact one.
Number = float | Fraction
# Fits positive factors of columns, each of shape (n,), to a measured force.
Solve = Callable[..., tuple[float, ...]]
# Force, and the rates of the states.
Reaction = tuple[LinearForm, list[LinearForm]]


@dataclass(frozen=True, slots=True)
class Element:
    """What touches, as springs and dampers: ``F = k (delta - d) + c delta'``, ``b d' = F - h d``.

    A law without memory has ``d = 0`` for ever.
    """

    # k, c: stiffness in N/m (N m/rad) and damping in N s/m (N m s/rad).
    k: float
    c: float = 0.0
    # h, b: stiffness and damping of the series element; b is infinite without memory.
    h: float = 0.0
    b: float = math.inf

    def push(self, deflection: float, velocity: float) -> float:
        """Return ``k delta + c delta'`` in N (N m), of the deflection beyond d."""
        return self.k * deflection + self.c * velocity


@dataclass(frozen=True)
class AbstractContactLaw(ABC):
    """Reaction force of an environment to its deflection; parameters are positive.

    A law is written for a linear motion (m, N) and for a rotation about the pivot (rad, N m)
    alike; `convert_to_pivot` converts from one to the other.
    """

    name: ClassVar[str]
    # Sentences about this law alone, by the ids of assumptions.
    sentences: ClassVar[Mapping[str, str]] = {}
    formula: ClassVar[str]
    # Kinds of the parameters, in order: stiffness, damping, or another kind.
    kinds: ClassVar[tuple[str, ...]]
    # The reaction may need the velocity, which a record has by differences only.
    takes_velocity: ClassVar[bool] = False

    @abstractmethod
    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples, shape (n,), in N (N m), exactly discretized."""

    @abstractmethod
    def sensitivities(self, motion: Motion) -> Array:
        """Return the derivatives of `simulate` by the logarithms of the parameters, (n, p)."""

    @classmethod
    def guesses(cls, motion: Motion, solve: Solve) -> Iterator[Self]:
        """Yield laws to begin a search from; by default of a law linear in its parameters."""
        unit = cls(*(1.0 for _ in cls.kinds))
        yield cls(*solve(*unit.sensitivities(motion).T))

    @abstractmethod
    def convert_to_pivot(self, radius: float) -> Self:
        """Return the law of the rotation, for a contact at this distance in m from the pivot."""

    @classmethod
    @abstractmethod
    def units(cls, *, rotational: bool) -> tuple[str, ...]:
        """Return the units of the parameters."""

    @property
    def relaxation_time(self) -> float | None:
        """Time constant in s in which the force relaxes at rest; None if it does not."""
        return None

    @property
    def values(self) -> tuple[float, ...]:
        """The parameters in the order of `parameters`."""
        return tuple(float(getattr(self, name)) for name in self.parameters())

    @classmethod
    def parameters(cls) -> tuple[str, ...]:
        """Return the names of the parameters."""
        return tuple(field.name for field in fields(cls))


@dataclass(frozen=True)
class AbstractNonlinearLaw(AbstractContactLaw):
    """A law that enters a design by its tangent: a spring and a damper about a deflection."""

    @classmethod
    @abstractmethod
    def build(cls, numbers: Mapping[str, float]) -> Self:
        """Return the law at the pivot from the numbers of its spec, by their keys."""

    @abstractmethod
    def slope(self, motion: Motion) -> Array:
        """Return the derivative of `simulate` by the deflection, shape (n,), in N/m (N m/rad)."""

    @abstractmethod
    def push(self, deflection: float, velocity: float) -> float:
        """Return the reaction at one instant, in N (N m), below zero where it would pull."""

    @abstractmethod
    def tangent(self, deflection: float) -> tuple[float, float]:
        """Return stiffness and damping of small motions about a deflection."""

    @abstractmethod
    def tangent_sensitivities(self, deflection: float) -> Array:
        """Return the derivatives of their logarithms by those of the parameters, (2, p)."""


@dataclass(frozen=True)
class AbstractLinearLaw(AbstractContactLaw):
    """A law that is linear, so that it can enter a design and a proof."""

    # Keys of the parameters in a spec, in their order.
    keys: ClassVar[tuple[str, ...]]
    # Parameters with `react` affine in their inverse; parameters that may be zero.
    inverse: ClassVar[frozenset[str]] = frozenset()
    may_vanish: ClassVar[frozenset[str]] = frozenset()
    # Names of the instantaneous stiffness and of the parallel damping ("" without damping).
    front: ClassVar[str]
    parallel_damping: ClassVar[str] = ""
    # The states of `react`; the first is the one that all environments of a spec share.
    states: ClassVar[tuple[str, ...]] = ("delta [rad]",)
    # The force may depend on earlier deflections.
    has_memory: ClassVar[bool] = False
    # The environment has a place of rest: a constant deflection keeps a force.
    has_rest: ClassVar[bool] = True
    # A mass may move with the contact: then the force needs the acceleration.
    has_mass: ClassVar[bool] = False

    def simulate(self, motion: Motion) -> Array:
        """Return the reaction, by default of a law that is linear in its parameters."""
        found: Array = self.sensitivities(motion).sum(axis=1)
        return found

    @property
    @abstractmethod
    def impedance(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """``Ze = F/v``: numerator and denominator in s, highest power first, of equal length."""

    def replace_stiffness(self, value: Fraction) -> Self:
        """Return the law with another stiffness, in N/m (N m/rad), that a sudden motion meets.

        By default all parameters grow in proportion. In every law the characteristic polynomial of
        a loop is affine in the stiffness.
        """
        share = value / Fraction(getattr(self, self.front))
        return type(self)(*(share * parameter for parameter in self.exact))

    @abstractmethod
    def react(self, velocity: LinearForm, states: Sequence[LinearForm]) -> Reaction:
        """Return the force and the rates of the states as linear forms of the loop state.

        The exact state space of `impedance`, pushed at a velocity in rad/s: affine in each
        parameter, or in its inverse.
        """

    def react_accelerated(
        self, velocity: LinearForm, acceleration: LinearForm, states: Sequence[LinearForm]
    ) -> Reaction:
        """Return force and rates as `react`, with the acceleration in rad/s^2 for a mass."""
        return self.react(velocity, states)

    @property
    @abstractmethod
    def element(self) -> Element:
        """The springs and dampers that it consists of."""

    @property
    def lags(self) -> bool:
        """Whether force or memory depend on the velocity."""
        velocity, *states = coordinates(1 + len(self.states))
        force, (_, *rates) = self.react_accelerated(velocity, zero(len(velocity)), states)
        return any(form[0] for form in (force, *rates))

    @property
    def is_spring(self) -> bool:
        """Whether the force follows from the deflection of the moment alone."""
        return not (self.has_memory or self.lags)

    @property
    def load(self) -> tuple[Fraction, Fraction]:
        """Stiffness k and damping b of ``F = k (delta - d) + b v``, all that a sampled loop takes.

        They are `front` and `beside`, and d moves at `memory_rates`; without these it is zero. An
        `AssemblyError` if `react` says anything else.
        """
        k = Fraction(getattr(self, self.front))
        b = Fraction(getattr(self, self.parallel_damping)) if self.parallel_damping else ZERO
        force, rates = [b, k], [[ONE, ZERO]]
        if self.memory_rates is not None:
            decays, follow_rate = self.memory_rates
            force, rates = (
                [b, k, -k],
                [[ONE, ZERO, ZERO], [ZERO, follow_rate, -decays - follow_rate]],
            )
        velocity, *states = coordinates(1 + len(self.states))
        if self.react(velocity, states) != (force, rates):
            raise AssemblyError(
                f"the law {self.name!r} is not F = k (δ - d) + b δ', all that a sampled loop takes",
                remedy="use an elastic, kelvin-voigt or kelvin-boltzmann environment",
                at=("environments",),
            )
        return k, b

    @property
    def memory_rates(self) -> tuple[Fraction, Fraction] | None:
        """Rates in 1/s at which a memory decays, and follows the deflection; None without one.

        While no force acts it decays, ``d' = -r1 d``; otherwise ``d' = r2 (delta - d) - r1 d``.
        """
        return None

    @classmethod
    def assumptions(cls, environment: str, *, is_only: bool) -> Iterator[Assumption]:
        """Yield the assumptions on an environment with memory or mass.

        `alone`: no other environment is touched.
        """
        if cls.has_memory:
            yield Assumption.create("memory.kept", environment=environment, states=cls.states)
            if not is_only:
                yield Assumption.create("memory.free", environment=environment)

    @property
    def exact(self) -> tuple[Fraction, ...]:
        """The parameters; a float is the binary number that it is."""
        return tuple(map(Fraction, astuple(self)))

    @property
    def stiffness(self) -> float:
        """Stiffness that a sudden motion meets, in N/m (N m/rad)."""
        return float(getattr(self, self.front))

    def convert_to_pivot(self, radius: float) -> Self:
        """Return the law with every parameter times ``r^2`` (thesis 6.3.1.1)."""
        return type(self)(*(turn(value, radius) for value in astuple(self)))

    @classmethod
    def units(cls, *, rotational: bool) -> tuple[str, ...]:
        """Return the units of the parameters, as a spec writes them."""
        return tuple(_UNITS[kind][rotational] for kind in cls.kinds)

    @classmethod
    def find_fault(cls, parameter: str, value: Number) -> str | None:
        """Return the range of forbidden values, if it holds the value of a parameter."""
        vanishes = parameter in cls.may_vanish
        if math.isfinite(value) and (value > 0 or (vanishes and value == 0)):
            return None
        return "< 0" if vanishes else "<= 0"

    def spec_fields(self) -> dict[str, str | float]:
        """Return the law and its parameters by the keys of a spec."""
        return {"model": self.name, **dict(zip(self.keys, self.values, strict=True))}

    def texts(self, unit: Callable[[str], str] = str) -> tuple[str, ...]:
        """Return the parameters at the pivot, such as ``k = 43 N*m/rad``, without what is zero."""
        parts = zip(self.parameters(), self.values, self.units(rotational=True), strict=True)
        return tuple(
            f"{name} = {float(v):.6g} {unit(unit_text)}" for name, v, unit_text in parts if v
        )


@dataclass(frozen=True)
class AbstractMemorylessLaw(AbstractLinearLaw):
    """A sum of stiffness, damping and mass, in this order, each times what it acts on."""

    def sensitivities(self, motion: Motion) -> Array:
        """Return the derivatives by the logarithms of the parameters, shape (n, p)."""
        import numpy as np

        pairs = zip(self.values, motion.derivatives, strict=False)
        return np.column_stack([value * part for value, part in pairs])

    @property
    def impedance(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """``(m s^2 + b s + k) / s``, without the powers that are absent."""
        numerator = (0.0,) * (2 - len(self.values)) + self.values[::-1]
        return numerator, (0.0,) * (len(numerator) - 2) + (1.0, 0.0)

    def replace_stiffness(self, value: Fraction) -> Self:
        """Return it with the same damping and mass."""
        return replace(self, **{self.front: value})

    @property
    def element(self) -> Element:
        """The spring and the parallel damper."""
        return Element(*self.values)

    def react(self, velocity: LinearForm, states: Sequence[LinearForm]) -> Reaction:
        """Return ``F = k delta + b v`` and ``delta' = v``."""
        (delta,) = states
        return combine(*zip(self.exact, (delta, velocity), strict=False)), [velocity]
