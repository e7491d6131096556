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
    ComplexArray,
    FloatArray,
    TransferFunction,
    frequency_response,
    hurwitz,
    trim,
)
from nrs_design.errors import DesignError
from nrs_design.models.contact import AbstractLinearLaw


@dataclass(frozen=True)
class ImpedanceLoop:
    """Motion loop in contact with a linear environment.

    Parameters
    ----------
    motion : TransferFunction
        Closed motion loop G, from commanded to actual velocity.
    contact : AbstractLinearLaw
        The environment as a rotation about the pivot, N m/rad and N m s/rad.
    Kt : float
        Spring of the admittance in N m/rad; zero is none.
    lags : tuple of float
        Denominator of the filter H of the force, whose numerator is 1: highest power of s first.

    Raises
    ------
    DesignError
        If a parameter is outside its domain, or there is a spring and no rest position.
    """

    motion: TransferFunction
    contact: AbstractLinearLaw
    Kt: float = 0.0
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

    def free(self, Mt: float, Bt: float) -> FloatArray:
        """Return the denominator of ``G Ze H Y``; an s that it has in common is left out.

        Parameters
        ----------
        Mt : float
            Virtual mass, kg m^2.
        Bt : float
            Virtual damping, N m s/rad.
        """
        return np.asarray(np.polyadd(np.convolve(self.forward[1], trim((Mt, Bt))), self.drawn))

    @property
    def drawn(self) -> FloatArray:
        """What the spring adds to that denominator: Kt times that of ``G Ze H``, over s."""
        return np.asarray(self.Kt * self.forward[1][:-1]) if self.Kt else np.zeros(1)


def open_loop(loop: ImpedanceLoop, Mt: float, Bt: float) -> TransferFunction:
    """Return ``G Ze H Y`` (thesis fig. 6.13, with the filter H) for mass Mt and damping Bt.

    Parameters
    ----------
    loop : ImpedanceLoop
        Motion loop and environment.
    Mt : float
        Virtual mass, kg m^2.
    Bt : float
        Virtual damping, N m s/rad.
    """
    check_admittance(Mt, Bt)
    numerator, _ = loop.forward
    return TransferFunction(tuple(numerator.tolist()), tuple(loop.free(Mt, Bt).tolist()))


def displayed_impedance_at(
    loop: ImpedanceLoop, Mt: float, Bt: float, omega: ArrayLike
) -> ComplexArray:
    """Evaluate ``Zdisp = G Ze / (1 + G Ze H Y)`` (thesis 6.3).

    Parameters
    ----------
    loop : ImpedanceLoop
        Motion loop and environment.
    Mt, Bt : float
        Admittance, kg m^2 and N m s/rad.
    omega : array_like
        Frequencies, rad/s; zero is allowed where there is no spring.

    Returns
    -------
    ndarray of complex
        Impedance, N m s/rad, in the shape of `omega`.
    """
    forward = np.convolve(loop.forward[0], loop.lags)
    if not loop.Kt:
        return _over_characteristic(loop, Mt, Bt, np.convolve(forward, trim((Mt, Bt))), omega)
    numerator = np.convolve(forward, trim((Mt, Bt, loop.Kt)))
    omega = np.asarray(omega, np.float64)
    return np.asarray(_over_characteristic(loop, Mt, Bt, numerator, omega) / (1j * omega))


def sensitivity(loop: ImpedanceLoop, Mt: float, Bt: float, omega: ArrayLike) -> ComplexArray:
    """Evaluate ``L = 1 / (1 + G Ze H Y)`` (thesis 6.5); parameters as `displayed_impedance_at`.

    Parameters
    ----------
    loop, Mt, Bt, omega
        As for `displayed_impedance_at`.
    """
    return _over_characteristic(loop, Mt, Bt, loop.free(Mt, Bt), omega)


def closed_loop_polynomial(loop: ImpedanceLoop, Mt: float, Bt: float) -> FloatArray:
    """Return the closed loop's characteristic polynomial, highest power first.

    Its degree is that of ``G Ze Y``: with a spring two more than the motion loop's order, and one
    more where Mt is zero.

    Parameters
    ----------
    loop, Mt, Bt
        As for `open_loop`.

    Raises
    ------
    DesignError
        If Mt is negative or Bt is not positive.
    """
    check_admittance(Mt, Bt)
    return np.asarray(
        trim(
            characteristic_polynomials(
                characteristic_basis(loop), np.array(Mt), np.array(Bt)
            ).tolist()
        )
    )


def stabilizes(loop: ImpedanceLoop, Mt: ArrayLike, Bt: ArrayLike) -> BoolArray:
    """Tell for which admittances the closed loop is Hurwitz (Mt and Bt broadcast).

    Parameters
    ----------
    loop : ImpedanceLoop
        Motion loop and environment.
    Mt : array_like
        Virtual masses, kg m^2.
    Bt : array_like
        Virtual damping, N m s/rad.
    """
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
    """Stack the characteristic polynomials; the leading entry is zero where Mt is.

    Parameters
    ----------
    basis : ndarray
        As `characteristic_basis` returns it.
    Mt, Bt : ndarray
        Admittances of one shape, kg m^2 and N m s/rad.
    """
    return np.asarray(Mt[..., None] * basis[0] + Bt[..., None] * basis[1] + basis[2])


def _over_characteristic(
    loop: ImpedanceLoop, Mt: float, Bt: float, numerator: FloatArray, omega: ArrayLike
) -> ComplexArray:
    closed = closed_loop_polynomial(loop, Mt, Bt)
    ratio = TransferFunction(tuple(numerator.tolist()), tuple(closed.tolist()))
    return frequency_response(ratio, omega)


def check_admittance(Mt: ArrayLike, Bt: ArrayLike) -> None:
    """Refuse gains outside their domain.

    Raises
    ------
    DesignError
        If an Mt is negative or a Bt is not positive.
    """
    if not (np.all(np.asarray(Mt) >= 0) and np.all(np.asarray(Bt) > 0)):
        raise DesignError("an admittance needs Mt >= 0 and Bt > 0")
