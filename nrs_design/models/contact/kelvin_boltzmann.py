"""Kelvin-Boltzmann tissue, the standard linear solid (thesis 2.5).

In a loop its second state is the deflection d of the damper: ``F = k2 (delta - d)`` and
``b d' = k2 (delta - d) - k1 d``. With the force for a state, as the thesis writes the law, it would
jump with k2; d is a position and stays. Every entry is affine in k1, in k2 and in 1/b.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
    Solve,
)
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.proof.assumption import Assumption

if TYPE_CHECKING:
    from nrs_design.models.contact.motion import Motion
    from nrs_design.models.contact.relaxation import Array


@dataclass(frozen=True)
class KelvinBoltzmann(AbstractLinearLaw):
    """A spring k2 in series with a Kelvin-Voigt element (spring k1, damper b)."""

    name: ClassVar[str] = "kelvin-boltzmann"
    sentences: ClassVar[Mapping[str, str]] = {
        "memory.damper": (
            "The damper of {environment} keeps its deflection at a switch "
            "and when the parameters change."
        ),
        "memory.creeps": (
            "While another environment is touched, {environment} is free of "
            "force and its damper creeps back to rest, b d' = -k1 d, with "
            "parameters in their ranges."
        ),
    }
    formula: ClassVar[str] = "F + η3 F' = η1 δ + η2 δ'"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS, STIFFNESS, DAMPING)
    keys: ClassVar[tuple[str, ...]] = ("parallel_stiffness", "series_stiffness", "damping")
    inverse: ClassVar[frozenset[str]] = frozenset({"b"})
    front: ClassVar[str] = "k2"
    has_memory: ClassVar[bool] = True
    states: ClassVar[tuple[str, ...]] = ("delta [rad]", "damper deflection [rad]")

    # k1, k2: stiffnesses in N/m (N m/rad).
    k1: Number
    k2: Number
    b: Number  # Damping in N s/m (N m s/rad)

    @classmethod
    def create_from_eta(cls, eta1: float, eta2: float, eta3: float) -> KelvinBoltzmann:
        """Return the elements that have these coefficients, in N/m, N s/m and s.

        ``k2 = eta2/eta3``, ``k1 = eta1 k2/(k2 - eta1)``, ``b = eta3 (k1 + k2)``. They are positive
        if ``eta2/eta3 > eta1``; else a `ValueError`.
        """
        k2 = eta2 / eta3
        if not k2 > eta1 > 0:
            raise ValueError(f"eta2/eta3 = {k2:g} must be above eta1 = {eta1:g}, both positive")
        k1 = eta1 * k2 / (k2 - eta1)
        return cls(k1, k2, eta3 * (k1 + k2))

    @property
    def eta(self) -> tuple[float, float, float]:
        """Coefficients eta1 in N/m, eta2 in N s/m and eta3 in s (N m/rad, N m s/rad, s)."""
        k1, k2, b = map(float, self.values)
        total = k1 + k2
        return k1 * k2 / total, b * k2 / total, b / total

    @property
    def relaxation_time(self) -> float:
        """``eta3`` in s."""
        return self.eta[2]

    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples, in N (N m).

        The law is a spring eta1 beside a Maxwell element with stiffness ``k2 - eta1``.
        """
        eta1, _, eta3 = self.eta
        return eta1 * motion.deflection + (float(self.k2) - eta1) * motion.relaxed(eta3).y

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivatives by log k1, log k2 and log b, shape (n, 3)."""
        import numpy as np

        eta1, _, eta3 = self.eta
        relaxed = motion.relaxed(eta3)
        y, slope = relaxed.y, relaxed.slope
        arm = float(self.k2) - eta1
        # By log eta1, log arm and log eta3, and then by the chain rule.
        inner = np.column_stack([eta1 * motion.deflection, arm * y, arm * slope])
        q = float(self.k2 / (self.k1 + self.k2))
        chain = np.array([[q, 1 - q, 0.0], [q - 1, 2 - q, 0.0], [q - 1, -q, 1.0]])
        return np.asarray(inner @ chain)

    @classmethod
    def guesses(cls, motion: Motion, solve: Solve) -> Iterator[KelvinBoltzmann]:
        """Yield the best law for each of some time constants."""
        for tau in motion.time_constants.tolist():
            eta1, arm = solve(motion.deflection, motion.relaxed(tau).y)
            yield cls.create_from_eta(eta1, (eta1 + arm) * tau, tau)

    @classmethod
    def assumptions(cls, environment: str, *, is_only: bool) -> Iterator[Assumption]:
        """Yield assumptions on the damper at a switch, and without contact."""
        yield Assumption.create("memory.damper", environment=environment)
        if not is_only:
            yield Assumption.create("memory.creeps", environment=environment)

    @property
    def impedance(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """``(b k2 s + k1 k2) / (s (b s + k1 + k2))``."""
        k1, k2, b = map(float, self.values)
        return (0.0, b * k2, k1 * k2), (b, k1 + k2, 0.0)

    @property
    def element(self) -> Element:
        """The spring k2 in series with the parallel spring k1 and damper."""
        return Element(float(self.k2), h=float(self.k1), b=float(self.b))

    def react(self, velocity: LinearForm, states: Sequence[LinearForm]) -> Reaction:
        """Return ``F = k2 (delta - d)``, ``delta' = v`` and ``b d' = k2 (delta - d) - k1 d``."""
        (k1, k2, b), (delta, d) = self.exact, states
        rate = combine((k2 / b, delta), (-(k1 + k2) / b, d))
        return combine((k2, delta), (-k2, d)), [velocity, rate]

    @property
    def memory_rates(self) -> tuple[Fraction, Fraction]:
        """``k1/b``, at which the spring k1 pulls the damper back, and ``k2/b`` of k2, in 1/s."""
        k1, k2, b = self.exact
        return k1 / b, k2 / b
