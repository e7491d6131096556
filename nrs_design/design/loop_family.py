"""The open loops of many admittances in one contact, from a few assembled modes.

`nrs_design.loop.cut_loop` gives the polynomials of a mode exactly. They are affine in the
stiffness of the contact, and in two coordinates of the law, so those of three admittances at two
stiffnesses are those of all. From here on it is floating point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from nrs_design.design.loops import Loops
from nrs_design.design.transfer import FloatArray, frequencies, hurwitz, product_parts, ratio
from nrs_design.loop.cut_loop import AbstractAxis, Place, ProcessorAxis
from nrs_design.models.contact import AbstractLinearLaw

_OPENED, _CLOSED, _FREE = "opened", "closed", "free"  # Names of the polynomials of a mode
# A virtual mass in kg m^2 that is next to none.
_SMALLEST = 1e-12
_CACHE_SIZE = 512


@dataclass(frozen=True)
class LoopFamily:
    """The loops of all admittances with one spring, in contacts that differ in stiffness alone."""

    axis: AbstractAxis  # Axis of the modes
    contact: AbstractLinearLaw  # Its own stiffness is not used
    spring: Fraction  # Kt in N m/rad; zero is none
    place: Place  # Motor and age of the force

    def loops(self, Mt: FloatArray, Bt: FloatArray, stiffness: FloatArray | float) -> Loops:
        """Return the open loops, cut where the law takes the force; all numbers are in SI."""
        return self._loops(_OPENED, Mt, Bt, stiffness)

    def felt(self, Mt: FloatArray, Bt: FloatArray, stiffness: FloatArray | float) -> Loops:
        """Return the open loops of who holds the robot, cut where the force acts on it."""
        return self._loops(_FREE, Mt, Bt, stiffness)

    def stiffness_limit(self, Mt: float, Bt: float) -> float:
        """Return the largest stiffness in N m/rad up to which the closed loop is stable throughout.

        The characteristic polynomial is ``A + k B``, so the limit is the smallest positive
        ``k = -A/B`` that is real on the imaginary axis. Infinite if no stiffness destabilizes the
        loop, 0 if it is unstable however soft the contact is.
        """
        (free,), (contact,) = self._polynomials(_CLOSED, np.array([Mt]), np.array([Bt]))
        rows = free[None], contact[None]
        critical = -ratio(*rows, frequencies(product_parts(*rows)[1]))[0].real
        ends = [-free[0] / contact[0]] if contact[0] else []
        limit = min((float(k) for k in (*critical, *ends) if k > 0), default=math.inf)
        probe = limit / 2 if math.isfinite(limit) else 1.0
        return limit if bool(hurwitz(free + probe * contact)) else 0.0

    def over_admittance(self, Mt: FloatArray, Bt: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return numerator and denominator from velocity to force of the law.

        That is ``1/(H Y)``, in s or what stands for it. Sampled, a delay is left out, whose
        magnitude is 1, and there is no spring.
        """
        n = len(Mt)
        if not isinstance(self.axis, ProcessorAxis):
            low_pass = getattr(self.axis, "low_pass", None)
            lags = (1.0,) if low_pass is None else low_pass.denominator
            spring = [np.full(n, float(self.spring))] if self.spring else []
            law = np.stack([Mt, Bt, *spring], axis=1)
            rows = np.array([np.convolve(row, lags) for row in law])
            return rows, np.tile((1.0, 0.0) if self.spring else (1.0,), (n, 1))
        half, (a, b) = float(self.axis.period) / 2, self._coordinates(Mt, Bt)
        factors = [np.ones((n, 1))]
        if Mt.any():
            factors.append(np.stack([(1 + a) * half, 1 - a], axis=1))
        if self.axis.low_pass is not None:
            lag = self.axis.low_pass.discretize(self.axis.period)
            p, q = float(lag.p), float(lag.q)
            factors += lag.order * [np.tile(((1 + p) * half / q, (1 - p) / q), (n, 1))]
        numerator, denominator = factors[0] / b[:, None], np.ones(1)
        for factor in factors[1:]:
            numerator = np.array(
                [np.convolve(*rows) for rows in zip(numerator, factor, strict=True)]
            )
            denominator = np.convolve(denominator, (half, 1.0))
        return numerator, np.tile(denominator, (n, 1))

    def _loops(
        self, cut_name: str, Mt: FloatArray, Bt: FloatArray, stiffness: FloatArray | float
    ) -> Loops:
        k = np.broadcast_to(np.asarray(stiffness, np.float64), Mt.shape)[:, None]
        denominator, numerator = (
            fixed + k * slope
            for fixed, slope in (
                self._polynomials(name, Mt, Bt) for name in (cut_name, f"from {cut_name}")
            )
        )
        period = self.axis.period
        return Loops(numerator, denominator, None if period is None else float(period))

    def _polynomials(
        self, name: str, Mt: FloatArray, Bt: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the polynomials at zero stiffness, and the change by 1 N m/rad."""
        p, q = self._coordinates(Mt, Bt)
        held, grown = (
            rows[0] + np.multiply.outer(p, rows[1]) + np.multiply.outer(q, rows[2])
            for rows in (self._inert if Mt.any() else self._static)[name]
        )
        return held, grown

    def _coordinates(self, Mt: FloatArray, Bt: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return two coordinates of the law in which the polynomials are affine."""
        if not isinstance(self.axis, ProcessorAxis):
            return Mt, Bt
        T, method = float(self.axis.period), self.axis.sampling.admittance
        if not Mt.any():
            return np.zeros_like(Bt), _single(1 / Bt)
        # Beside others, zero inertia counts as a tiny one.
        Mt = np.maximum(Mt, _SMALLEST)
        if method == "euler":
            return _single(1 - Bt * T / Mt), _single(T / Mt)
        return _single(np.exp(-Bt * T / Mt)), _single(-np.expm1(-Bt * T / Mt) / Bt)

    @cached_property
    def _inert(self) -> dict[str, FloatArray]:
        return _basis(self, inert=True)

    @cached_property
    def _static(self) -> dict[str, FloatArray]:
        return _basis(self, inert=False)


# Controllers with the same contact share them, and so do choice and analysis of gains.
@lru_cache(maxsize=_CACHE_SIZE)
def _basis(family: LoopFamily, *, inert: bool) -> dict[str, FloatArray]:
    """Return the polynomials by name, shape (2, 3, n): at no stiffness and of 1 N m/rad."""
    rows = [
        family.axis.admittances(
            family.contact.replace_stiffness(Fraction(k)), family.spring, family.place, inert=inert
        )
        for k in (1, 2)
    ]
    exact = {
        name: np.array([[getattr(loop, name) for loop in three] for three in rows], dtype=object)
        for name in (_OPENED, _FREE, _CLOSED)
    }
    for cut_name in (_OPENED, _FREE):
        exact[f"from {cut_name}"] = exact[_CLOSED] - exact[cut_name]
    return {name: _affine(values) for name, values in exact.items()}


def _affine(values: NDArray[np.object_]) -> FloatArray:
    """Return the parts of what is affine in a stiffness of 1 and 2, and in `COORDINATES`."""
    unit, first, second = values[:, 0], values[:, 1], values[:, 2]
    p, q = first - unit, second - unit
    parts = np.stack([unit - 2 * (p + q), p, q], axis=1)
    return np.stack([2 * parts[0] - parts[1], parts[1] - parts[0]]).astype(np.float64)


def _single(values: FloatArray) -> FloatArray:
    """Round to single precision."""
    return values.astype(np.float32).astype(np.float64)
