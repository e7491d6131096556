"""Hunt-Crossley tissue, ``F = rho delta^phi + lam delta^phi ddelta`` (thesis 2.18)."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from nrs_design.models.contact.law import AbstractNonlinearLaw, Solve

if TYPE_CHECKING:
    from nrs_design.models.contact.motion import Motion
    from nrs_design.models.contact.relaxation import Array

# The thesis takes phi between these, and then 1.2.
LEAST_EXPONENT, LARGEST_EXPONENT = 1.1, 1.3


@dataclass(frozen=True)
class HuntCrossley(AbstractNonlinearLaw):
    """A spring and a damper that both stiffen with the deflection; no force without contact."""

    name: ClassVar[str] = "hunt-crossley"
    sentences: ClassVar[Mapping[str, str]] = {
        "preload.hunt-crossley": (
            "{environment} is a Hunt-Crossley law whose deflection stays "
            "between {low} and {high}. About a rest anywhere from its "
            "surface to {high}, at which the commands hold every mode "
            "whatever its parameters, its force is then that at rest, plus "
            "k times the deflection from there, plus b times the velocity, "
            "exactly, with k and b moving in the ranges of the modes: "
            "motions need not be small or slow. Nothing is said once the "
            "deflection has left this preload, nor of the difference of two "
            "motions of which neither is at rest. The law moves k and b "
            "together, so what is refuted with any such k and b may hold "
            "with it."
        ),
    }
    formula: ClassVar[str] = "F = ρ δ^φ + λ δ^φ δ' in contact"
    kinds: ClassVar[tuple[str, ...]] = ("power stiffness", "power damping", "exponent")
    takes_velocity: ClassVar[bool] = True

    rho: float  # In N/m^phi (N m/rad^phi)
    lam: float  # In N s/m^(phi+1) (N m s/rad^(phi+1))
    phi: float  # Exponent

    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples, in N (N m); 0 where the deflection is negative."""
        import numpy as np

        power = np.maximum(motion.deflection, 0.0) ** self.phi
        return np.asarray(power * (self.rho + self.lam * motion.velocity))

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivatives by log rho, log lam and log phi, shape (n, 3)."""
        import numpy as np

        contact = np.maximum(motion.deflection, 0.0)
        power = contact**self.phi
        # delta^phi log(delta) goes to 0 with delta.
        logarithm = np.log(contact, out=np.zeros_like(contact), where=contact > 0)
        spring, damper = self.rho * power, self.lam * power * motion.velocity
        return np.column_stack([spring, damper, self.phi * logarithm * (spring + damper)])

    @classmethod
    def guesses(cls, motion: Motion, solve: Solve) -> Iterator[HuntCrossley]:
        """Yield the best law for each of some exponents."""
        import numpy as np

        for phi in np.linspace(LEAST_EXPONENT, LARGEST_EXPONENT, 3).tolist():
            power = np.maximum(motion.deflection, 0.0) ** phi
            rho, lam = solve(power, power * motion.velocity)
            yield cls(rho, lam, phi)

    def slope(self, motion: Motion) -> Array:
        """Return the derivative of `simulate` by the deflection, shape (n,), in N/m (N m/rad)."""
        import numpy as np

        power = self.phi * np.maximum(motion.deflection, 0.0) ** (self.phi - 1)
        touching = motion.deflection > 0
        return np.asarray(touching * power * (self.rho + self.lam * motion.velocity))

    def convert_to_pivot(self, radius: float) -> HuntCrossley:
        """Return ``rho r^(phi+1)`` and ``lam r^(phi+2)``; the exponent stays."""
        return HuntCrossley(
            self.rho * radius ** (self.phi + 1), self.lam * radius ** (self.phi + 2), self.phi
        )

    @classmethod
    def units(cls, *, rotational: bool) -> tuple[str, ...]:
        """Return the units of rho and lam; the exponent has none."""
        force, length = ("N*m", "rad") if rotational else ("N", "m")
        return f"{force}/{length}^φ", f"{force}*s/{length}^(φ+1)", ""

    def push(self, deflection: float, velocity: float) -> float:
        """Return ``(rho + lam v) delta^phi``; 0 without contact."""
        return 0.0 if deflection <= 0 else (self.rho + self.lam * velocity) * deflection**self.phi

    @classmethod
    def build(cls, numbers: Mapping[str, float]) -> HuntCrossley:
        """Return the law with this tangent at ``about``."""
        tangent = numbers["stiffness"], numbers["damping"]
        return cls.through(*tangent, numbers["exponent"], numbers["about"])

    @classmethod
    def through(cls, k: float, b: float, phi: float, deflection: float) -> HuntCrossley:
        """Return the law whose tangent at a deflection has this stiffness and damping, in SI."""
        rho = k / (phi * deflection ** (phi - 1))
        return cls(rho, b / deflection**phi, phi)

    def tangent(self, deflection: float) -> tuple[float, float]:
        """Return stiffness and damping of small motions about a deflection.

        ``k = phi rho delta0^(phi-1)`` and ``b = lam delta0^phi``: how this law enters a linear
        design.
        """
        k = self.phi * self.rho * deflection ** (self.phi - 1)
        return k, self.lam * deflection**self.phi

    def tangent_sensitivities(self, deflection: float) -> Array:
        """Return the derivatives of log k and log b by log rho, log lam and log phi, (2, 3)."""
        import numpy as np

        grows = self.phi * math.log(deflection)
        return np.array([[1.0, 0.0, 1.0 + grows], [0.0, 1.0, grows]])
