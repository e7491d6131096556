"""Around a chosen admittance: the cost over Mt and Bt, what it gives up, and the delay it bears.

All of it is floating point, in contact with the nominal environment, and no part of any proof.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.design.impedance import (
    ImpedanceLoop,
    characteristic_basis,
    characteristic_polynomials,
    stabilizes,
)
from nrs_design.design.impedance_optimum import (
    ImpedanceProblem,
    impedance_cost,
    optimize_impedance,
)
from nrs_design.design.loops import Loops
from nrs_design.design.transfer import FloatArray, trim
from nrs_design.errors import DesignError

_POINTS = 100
# How far beyond the bounds the map looks, and by how much a bound that holds the optimum is moved.
_BEYOND, _FURTHER = 4.0, 10.0
# Where a bound of Mt is zero, the map ends at this share of the other.
_LEAST = 1e-3


@dataclass(frozen=True, eq=False)
class CostMap:
    """The cost over both gains.

    Parameters
    ----------
    Mt, Bt : ndarray, shapes (m,) and (b,)
        Virtual masses in kg m^2 and dampings in N m s/rad, ascending.
    cost : ndarray, shape (b, m)
        NaN where the nominal loop is not stable.
    abscissa : ndarray, shape (b, m)
        Largest real part of the poles of the nominal loop in 1/s: it is zero on the border.
    """

    Mt: FloatArray
    Bt: FloatArray
    cost: FloatArray
    abscissa: FloatArray


@dataclass(frozen=True, slots=True)
class Alternative:
    """Another admittance, and what it costs.

    Parameters
    ----------
    name : str
        What it is best for.
    Mt, Bt : float
        In kg m^2 and N m s/rad.
    cost : float
        With the weights of the design.
    displayed : float
        Mean distance of the displayed impedance from the desired one, in decades.
    sensitivity : float
        Mean sensitivity.
    """

    name: str
    Mt: float
    Bt: float
    cost: float
    displayed: float
    sensitivity: float


def map_cost(problem: ImpedanceProblem, Mt: float, Bt: float) -> CostMap:
    """Evaluate the cost within the bounds, around them, and around a point.

    Parameters
    ----------
    problem : ImpedanceProblem
        What is minimized.
    Mt, Bt : float
        The point, in kg m^2 and N m s/rad.
    """
    masses, dampings = (
        np.geomspace(*_ends(bounds, value), _POINTS)
        for bounds, value in ((problem.mass_bounds, Mt), (problem.damping_bounds, Bt))
    )
    grid = np.meshgrid(masses, dampings)
    cost = np.where(stabilizes(problem.loop, *grid), impedance_cost(problem, *grid), np.nan)
    return CostMap(masses, dampings, cost, _abscissa(problem.loop, *grid))


def _abscissa(loop: ImpedanceLoop, Mt: FloatArray, Bt: FloatArray) -> FloatArray:
    """Return the largest real part of the poles, as eigenvalues of companion matrices."""
    closed = characteristic_polynomials(characteristic_basis(loop), Mt, Bt)
    order = closed.shape[-1] - 1
    companion = np.zeros((*Mt.shape, order, order))
    companion[..., 0, :] = -closed[..., 1:] / closed[..., :1]
    companion[..., range(1, order), range(order - 1)] = 1.0
    return np.asarray(np.linalg.eigvals(companion).real.max(axis=-1), dtype=np.float64)


def _ends(bounds: tuple[float, float], value: float) -> tuple[float, float]:
    high = max(bounds[1], value) or 1.0
    low = min(bounds[0], value) or _LEAST * high
    return low / _BEYOND, high * _BEYOND


def alternatives(problem: ImpedanceProblem, Mt: float, Bt: float) -> Iterator[Alternative]:
    """Yield the shipped gains, those best for either part of the cost, and those beyond a bound.

    Goals are not looked at: they may be why a cheaper admittance was not chosen.

    Parameters
    ----------
    problem : ImpedanceProblem
        What was minimized.
    Mt, Bt : float
        As shipped, in kg m^2 and N m s/rad.
    """
    yield _priced(problem, "as shipped", Mt, Bt)
    tries = (
        ("best for the displayed impedance alone", _weighted(problem, 1.0, 0.0)),
        ("best for the sensitivity alone", _weighted(problem, 0.0, 1.0)),
        *_widened(problem, Mt, Bt),
    )
    for name, other in tries:
        try:
            best = optimize_impedance(other)
        except DesignError:
            continue  # No admittance within the bounds is stable.
        yield _priced(problem, name, best.Mt, best.Bt)


def _weighted(problem: ImpedanceProblem, displayed: float, robust: float) -> ImpedanceProblem:
    return replace(problem, weight_displayed=displayed, weight_sensitivity=robust)


def _widened(
    problem: ImpedanceProblem, Mt: float, Bt: float
) -> Iterator[tuple[str, ImpedanceProblem]]:
    """Yield the same problem without the bounds that the gains lie on, ten times further out."""
    for end, bounds in _further(problem.mass_bounds, Mt):
        yield f"with {end} bound of Mt", replace(problem, mass_bounds=bounds)
    for end, bounds in _further(problem.damping_bounds, Bt):
        yield f"with {end} bound of Bt", replace(problem, damping_bounds=bounds)


def _further(
    bounds: tuple[float, float], value: float
) -> Iterator[tuple[str, tuple[float, float]]]:
    low, high = bounds
    if low == high:
        return
    if low > 0 and np.isclose(value, low, rtol=1e-6):
        yield "a tenth of the lower", (low / _FURTHER, high)
    elif np.isclose(value, high, rtol=1e-6):
        yield "ten times the upper", (low, _FURTHER * high)


def _priced(problem: ImpedanceProblem, name: str, Mt: float, Bt: float) -> Alternative:
    costs = (
        float(impedance_cost(p, Mt, Bt))
        for p in (problem, _weighted(problem, 1.0, 0.0), _weighted(problem, 0.0, 1.0))
    )
    return Alternative(name, Mt, Bt, *costs)


def delay_borne(loop: ImpedanceLoop, Mt: float, Bt: float, stiffness: FloatArray) -> FloatArray:
    """Return the smallest dead time in s that destabilizes, over the stiffness of the contact.

    Zero where the loop is unstable without any; infinite where no dead time destabilizes.

    Parameters
    ----------
    loop : ImpedanceLoop
        Motion loop and law of the environment; its own stiffness is not used.
    Mt, Bt : float
        Admittance, kg m^2 and N m s/rad.
    stiffness : ndarray, shape (k,)
        N m/rad, positive.
    """
    held, grown = loop.contact.by_stiffness
    motion = np.asarray(loop.motion.numerator)
    free = loop.free(Mt, Bt)
    rows = [
        np.polymul(motion, trim(np.polyadd(held, k * np.asarray(grown)).tolist()))
        for k in stiffness
    ]
    width = max(len(free), *map(len, rows))
    numerator = np.stack([np.pad(row, (width - len(row), 0)) for row in rows])
    denominator = np.tile(np.pad(free, (width - len(free), 0)), (len(rows), 1))
    return Loops(numerator, denominator).delay_margin()
