"""The laws as a processor computes them once a period, with the coefficients that ship.

Every coefficient is a single-precision number; what the arithmetic rounds besides is another
matter. The position is taken at the sample, the force sample may be older.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.controllers.float32 import to_float32
from nrs_design.errors import DesignError

if TYPE_CHECKING:
    from nrs_design.controllers.laws import ProportionalDerivative


@dataclass(frozen=True, slots=True)
class SampledMotion:
    """``u = Kp e + D (e - e_before)``, with the backward difference for the derivative.

    Parameters
    ----------
    Kp : Fraction
        In rpm/rad.
    D : Fraction
        Kd over the period, in rpm/rad.
    """

    Kp: Fraction
    D: Fraction

    @classmethod
    def of(cls, law: ProportionalDerivative, period: Fraction) -> SampledMotion:
        """Discretize the PD law (thesis 4.3) for a period in s."""
        return cls(law.Kp, to_float32(law.Kd / period))


@dataclass(frozen=True, slots=True)
class SampledAdmittance:
    """``v+ = a v + b F``, and the reference moves on by ``-T v``; without inertia ``v = b F``.

    With a spring F is the force sample plus Kt times the offset that the reference has by then.

    Parameters
    ----------
    a : Fraction or None
        Without unit; None for a law without inertia.
    b : Fraction
        In rad/(s N m).
    T : Fraction
        The period as the processor holds it, in s.
    Kt : Fraction
        In N m/rad; zero is no spring.
    """

    a: Fraction | None
    b: Fraction
    T: Fraction
    Kt: Fraction = Fraction(0)

    @property
    def lasting_gain(self) -> Fraction:
        """Velocity over a lasting force without a spring, rad/(s N m): 1/Bt, but for rounding.

        Raises
        ------
        DesignError
            If the step forgets nothing, so that the velocity grows as long as the force lasts.
        """
        if self.a is None:
            return self.b
        if self.a == 1:
            raise DesignError(
                "the damping is lost in single precision: a step keeps all of the velocity",
                remedy="raise Bt, lower Mt, or sample with a longer period",
            )
        return self.b / (1 - self.a)

    @property
    def coefficients(self) -> dict[str, Fraction]:
        """The coefficients by name."""
        first = {} if self.a is None else {"a": self.a}
        last = {"Kt": self.Kt} if self.Kt else {}
        return {**first, "b": self.b, "T": self.T, **last}
