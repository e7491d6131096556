"""The laws as a processor computes them once a period: the coefficients that ship.

Every coefficient is a single-precision number, and so is every result of the operations that
`nrs_design.controllers.step_law` lists:

    x1 = p x1 + q F              (where the force is filtered; then x2 = p x2 + q x1, ...)
    e = xref - theta
    u = Kp e + D (e - e_before)
    F = x1 + Kt (xref - xcom)    (with a spring; x1 is the last lag, or the force sample)
    xref = xref + T (v - vm)
    vm = a vm + b F              (without inertia vm = b F, before it is used)

where xcom is what the command alone makes of the reference. Force and position control have the
other half of it, which comes before the error and not after it:

    xref = X + Kp (Fd - x1)      (its own Kp; without it, position control; X is commanded)
    vm = d vm,  r = d r          (idle: the velocity and the reference of impedance controllers)

and an integral w of the force error, which is in the reference of every controller:

    w = w + Ki_T (Fd - x1)       (with its own gain; w = g w while another controller is active)

Rounding to nearest changes a result by at most 2^-24 of its size, so a term that takes part in n
roundings changes by at most `rounding_share` of n of its own. A fused product and sum rounds once
less. The position is taken at the sample, the force sample may be older.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.float32 import PRECISION
from nrs_design.errors import DesignError

# Half a unit in the last place, over the number.
UNIT = Fraction(1, 2**PRECISION)


def rounding_share(count: int) -> Fraction:
    """Return how much so many roundings change a term at most, over its size.

    That is ``n u / (1 - n u)`` with ``u = 2^-24``, and ``n u (1 + 2^-20)`` is not less for n up to
    15: a dyadic number.

    Parameters
    ----------
    count : int
        The n, from 1 to 15.

    Raises
    ------
    ValueError
        If there are more.
    """
    if not 1 <= count <= 15:
        raise ValueError(f"{count} roundings are not counted")
    return count * UNIT * (1 + Fraction(1, 2**20))


@dataclass(frozen=True, slots=True)
class SampledMotion:
    """``u = Kp e + D (e - e_before)``, with the backward difference for the derivative."""

    Kp: Fraction  # In rpm/rad
    D: Fraction  # Kd over the period, in rpm/rad


@dataclass(frozen=True, slots=True)
class SampledAdmittance:
    """``v+ = a v + b F``, and the reference moves on by ``-T v``; without inertia ``v = b F``.

    With a spring F is the force sample plus Kt times the offset that the reference has by then.
    """

    a: Fraction | None  # Without unit; None for a law without inertia
    b: Fraction  # In rad/(s N m)
    T: Fraction  # The period as the processor holds it, in s
    Kt: Fraction = Fraction(0)  # In N m/rad; zero is no spring

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


@dataclass(frozen=True, slots=True)
class SampledForce:
    """``xref = X + Kp (Fd - F) + w``, before the error is formed; without Kp, position control."""

    Kp: Fraction  # In rad/(N m); zero takes no force
    # What a sample adds to the integral, ``w+ = w + Ki_T (Fd - F)``, in rad/(N m); zero is no
    # integral of its own.
    Ki_T: Fraction = Fraction(0)

    @property
    def coefficients(self) -> dict[str, Fraction]:
        """The coefficients by name, as far as there are any."""
        named = {"Kp": self.Kp, "Ki_T": self.Ki_T}
        return {name: value for name, value in named.items() if value}


SampledLaw = SampledAdmittance | SampledForce
