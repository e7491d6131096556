"""The laws as a processor computes them once a period, with the coefficients that ship.

Every coefficient is a single-precision number; what the arithmetic rounds besides is another
matter. The position is taken at the sample, the force sample may be older.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import Admittance, ProportionalDerivative
from nrs_design.proof.taylor import exponential_between


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

    Parameters
    ----------
    a : Fraction or None
        Without unit; None for a law without inertia.
    b : Fraction
        In rad/(s N m).
    T : Fraction
        The period as the processor holds it, in s.
    """

    a: Fraction | None
    b: Fraction
    T: Fraction

    @classmethod
    def of(cls, law: Admittance, period: Fraction, method: str) -> SampledAdmittance:
        """Discretize ``Mt v' + Bt v = F`` (thesis 6.8).

        Parameters
        ----------
        law : Admittance
            With its gains.
        period : Fraction
            In s.
        method : {"exact", "euler"}
            Exact for a force that is held: ``a = exp(-Bt T/Mt)`` and ``b = (1 - a)/Bt``, or
            ``a = 1 - Bt T/Mt`` and ``b = T/Mt``.

        Raises
        ------
        DesignError
            If a coefficient is beyond single precision.
        """
        T = to_float32(period)
        if law.Mt == 0:
            return cls(None, to_float32(1 / law.Bt), T)
        step = law.Bt * period / law.Mt
        if method == "euler":
            return cls(to_float32(1 - step), to_float32(period / law.Mt), T)
        a, _ = exponential_between(-step)
        return cls(to_float32(a), to_float32((1 - a) / law.Bt), T)

    @property
    def coefficients(self) -> dict[str, Fraction]:
        """The coefficients by name."""
        return ({} if self.a is None else {"a": self.a}) | {"b": self.b, "T": self.T}
