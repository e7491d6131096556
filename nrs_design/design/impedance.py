"""Impedance control: the loop of the thesis (fig. 6.13).

The admittance ``Y = 1/(Mt s + Bt)`` turns the measured torque into a velocity that is taken off
the commanded one; the motion loop G follows the difference, and the environment
``Ze = k/s + b`` answers: open loop ``G Ze Y``. A spring Kt, which is given and not chosen, makes it
``Y = 1/(Mt s + Bt + Kt/s)``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.design.transfer import (
    BoolArray,
    FloatArray,
    TransferFunction,
    hurwitz,
    trim,
)
from nrs_design.errors import DesignError
from nrs_design.models.contact import AbstractLinearLaw


@dataclass(frozen=True)
class ImpedanceLoop:
    """Motion loop in contact with a linear environment."""

    motion: TransferFunction  # Closed motion loop G, from commanded to actual velocity
    # The environment as a rotation about the pivot, N m/rad and N m s/rad.
    contact: AbstractLinearLaw
    Kt: float = 0.0  # Spring of the admittance in N m/rad; zero is none
    # Denominator of the filter H of the force, whose numerator is 1: highest power of s first.
    lags: tuple[float, ...] = (1.0,)

    def __post_init__(self) -> None:
        """Check the environment."""
        law = self.contact
        for index, (kind, value) in enumerate(zip(law.kinds, law.values, strict=True)):
            if not law.admits(index, value):
                must = "not be negative" if law.admits(index, 0) else "be positive"
                raise DesignError(f"the {kind} must {must}: {value}")
        if not (math.isfinite(self.Kt) and self.Kt >= 0):
            raise DesignError(f"Kt must not be negative: {self.Kt}", at=("Kt",))
        if self.Kt and not law.has_rest:
            raise DesignError(
                f"an admittance with a spring Kt is not modelled in contact that is {law.name}, "
                "which has no rest position",
                remedy="leave Kt out",
                at=("Kt",),
            )

    @property
    def forward(self) -> tuple[FloatArray, FloatArray]:
        """Numerator and denominator of ``G Ze H``, highest power of s first."""
        numerator, denominator = self.contact.impedance
        return (
            np.convolve(self.motion.numerator, trim(numerator)),
            np.convolve(np.convolve(self.motion.denominator, trim(denominator)), self.lags),
        )

    @property
    def drawn(self) -> FloatArray:
        """What the spring adds to the denominator of L: Kt times that of ``G Ze H``, over s."""
        return np.asarray(self.Kt * self.forward[1][:-1]) if self.Kt else np.zeros(1)


def stabilizes(loop: ImpedanceLoop, Mt: ArrayLike, Bt: ArrayLike) -> BoolArray:
    """Tell for which admittances the closed loop is Hurwitz (Mt and Bt broadcast)."""
    Mt, Bt = np.broadcast_arrays(np.asarray(Mt, np.float64), np.asarray(Bt, np.float64))
    return hurwitz(characteristic_polynomials(characteristic_basis(loop), Mt, Bt))


def characteristic_basis(loop: ImpedanceLoop) -> FloatArray:
    """Return the rows M, B, C of the characteristic polynomial ``Mt M + Bt B + C``."""
    contact, den = loop.forward
    basis = np.zeros((3, len(den) + 1))
    basis[0, :-1] = den
    basis[1, 1:] = den
    basis[2, len(den) + 1 - len(contact) :] = contact
    basis[2, len(den) + 1 - len(loop.drawn) :] += loop.drawn
    return basis


def characteristic_polynomials(basis: FloatArray, Mt: FloatArray, Bt: FloatArray) -> FloatArray:
    """Stack the characteristic polynomials; the leading entry is zero where Mt is."""
    return np.asarray(Mt[..., None] * basis[0] + Bt[..., None] * basis[1] + basis[2])


def check_admittance(Mt: ArrayLike, Bt: ArrayLike) -> None:
    """Refuse an Mt that is negative, and a Bt that is not positive."""
    if not (np.all(np.asarray(Mt) >= 0) and np.all(np.asarray(Bt) > 0)):
        raise DesignError("an admittance needs Mt >= 0 and Bt > 0")
