"""Maxwell tissue, ``F + (b/k) dF = b ddelta`` (thesis 2.5).

It has no rest position: a constant deflection leaves no force in the end. A loop around it is
described by the stretch of the spring, ``e' = v - (k/b) e``, ``F = k e``. The deflection follows
from the motion and acts on nothing; as a state it would add an eigenvalue zero.
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
class Maxwell(AbstractLinearLaw):
    """A spring and a damper in a row."""

    name: ClassVar[str] = "maxwell"
    sentences: ClassVar[Mapping[str, str]] = {
        "memory.maxwell": (
            "{environment} has no rest position: a lasting deflection "
            "leaves no force. Its state is the stretch of its spring, which "
            "stays at a switch and when the parameters change; that the "
            "deflection itself returns to zero is not claimed, nor that it "
            "stays bounded under a command or other input."
        ),
    }
    formula: ClassVar[str] = "F + (b/k) F' = b δ'"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS, DAMPING)
    keys: ClassVar[tuple[str, ...]] = ("stiffness", "damping")
    inverse: ClassVar[frozenset[str]] = frozenset({"b"})
    front: ClassVar[str] = "k"
    has_memory: ClassVar[bool] = True
    states: ClassVar[tuple[str, ...]] = ("spring stretch [rad]",)
    has_rest: ClassVar[bool] = False

    k: Number  # Stiffness in N/m (N m/rad)
    b: Number  # Damping in N s/m (N m s/rad)

    @property
    def relaxation_time(self) -> float:
        """``b/k`` in s."""
        return float(self.b / self.k)

    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples, in N (N m)."""
        return float(self.k) * motion.relaxed(self.relaxation_time).y

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivatives by log k and log b, shape (n, 2)."""
        import numpy as np

        relaxed = motion.relaxed(self.relaxation_time)
        y, slope = relaxed.y, relaxed.slope
        return np.column_stack([float(self.k) * (y - slope), float(self.k) * slope])

    @classmethod
    def guesses(cls, motion: Motion, solve: Solve) -> Iterator[Maxwell]:
        """Yield the best law for each of some time constants."""
        for tau in motion.time_constants.tolist():
            (k,) = solve(motion.relaxed(tau).y)
            yield cls(k, k * tau)

    @classmethod
    def assumptions(cls, environment: str, *, is_only: bool) -> Iterator[Assumption]:
        """Yield the assumption on the deflection, which is no state."""
        yield Assumption.create("memory.maxwell", environment=environment)

    @property
    def impedance(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """``k b / (b s + k)``."""
        k, b = float(self.k), float(self.b)
        return (0.0, k * b), (b, k)

    @property
    def element(self) -> Element:
        """The spring, and the damper behind it."""
        return Element(float(self.k), b=float(self.b))

    def react(self, velocity: LinearForm, states: Sequence[LinearForm]) -> Reaction:
        """Return ``F = k e`` and ``e' = v - (k/b) e`` with the stretch e of the spring."""
        (k, b), (e,) = self.exact, states
        return combine((k, e)), [combine((Fraction(1), velocity), (-k / b, e))]
