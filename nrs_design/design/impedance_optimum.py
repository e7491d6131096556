"""The best admittance for a loop of impedance control: loop, cost and search (thesis 6.4 to 6.9).

The admittance ``Y = 1/(Mt s + Bt)`` turns the measured torque into a velocity that is taken off
the commanded one; the motion loop G follows the difference, and the environment
``Ze = k/s + b`` answers: open loop ``G Ze Y`` (fig. 6.13). A spring Kt, which is given and not
chosen, makes it ``Y = 1/(Mt s + Bt + Kt/s)``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.axis import unit
from nrs_design.controllers.controller_design import ImpedanceOptimum
from nrs_design.design.pattern_search import Objective, Points, local_minima, refine, snap
from nrs_design.design.transfer import (
    BoolArray,
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
    """Motion loop in contact with a linear environment."""

    motion: TransferFunction  # Closed motion loop G, from commanded to actual velocity
    # The environment as a rotation about the pivot, N m/rad and N m s/rad.
    contact: AbstractLinearLaw
    Kt: float = 0.0  # Spring of the admittance in N m/rad; zero is none
    # Denominator of the filter H of the force, whose numerator is 1: highest power of s first.
    lags: tuple[float, ...] = (1.0,)

    def __post_init__(self) -> None:
        """Refuse a spring where contact has no rest position."""
        if self.Kt and not self.contact.has_rest:
            raise DesignError(
                "an admittance with a spring Kt is not modelled in contact that is "
                f"{self.contact.name}, which has no rest position",
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
    return hurwitz(characteristic_polynomials(loop, Mt, Bt))


def characteristic_polynomials(loop: ImpedanceLoop, Mt: FloatArray, Bt: FloatArray) -> FloatArray:
    """Stack the characteristic polynomials; the leading entry is zero where Mt is."""
    contact, den = loop.forward
    rest = np.zeros(len(den) + 1)
    rest[-len(contact) :] = contact
    rest[-len(loop.drawn) :] += loop.drawn
    inert, damped = np.append(den, 0.0), np.insert(den, 0, 0.0)
    return np.asarray(Mt[..., None] * inert + Bt[..., None] * damped + rest)


# Midpoint rule over (0, bandwidth]. The absolute value in the cost has kinks, which spoil a
# Gauss rule; with 256 midpoints the cost is within 1e-6 of its integral on the published designs
# and the optimal Bt within 3e-4.
NODES = 256
_SCAN_NODES = 32
_VALLEY_NODES = 64
_BLOCK = 256

_SCAN = (25, 41)
_STARTS = 4
_VALLEY_TOLERANCE = 5e-3
_STEP_TOLERANCE = 1e-5


@dataclass(frozen=True)
class ImpedanceProblem:
    """What the admittance is chosen for."""

    loop: ImpedanceLoop  # Motion loop and nominal environment
    desired: float  # Desired impedance Zdes, N m s/rad, positive
    bandwidth: float  # Highest frequency of the command, rad/s, positive
    # mass_bounds, damping_bounds: lowest and highest Mt (kg m^2, not negative) and Bt (N m s/rad,
    # positive). Equal bounds fix the parameter.
    mass_bounds: tuple[float, float]
    damping_bounds: tuple[float, float]
    # weight_displayed, weight_sensitivity: weights wD and wR of the two parts of the cost, not
    # negative and not both zero.
    weight_displayed: float = 0.5
    weight_sensitivity: float = 0.5
    # Tells for which Mt and Bt nominal contact is stable, of the loop that is proved; by default
    # that of the `loop` is asked for.
    stable: Callable[[FloatArray, FloatArray], BoolArray] | None = None


def impedance_cost(problem: ImpedanceProblem, Mt: ArrayLike, Bt: ArrayLike) -> FloatArray:
    """Evaluate the cost of thesis 6.4-6.7, written as a mean over frequency.

    ``C = wD mean|log10 Zdes - log10|Zdisp|| + wR mean|L|`` over ``(0, bandwidth]``: the integral
    divided by the bandwidth, by the midpoint rule with `NODES` equidistant frequencies. The
    thesis prints a sum, whose value would depend on the number of frequencies. Mt and Bt broadcast;
    stability is not checked.
    """
    Mt, Bt = np.broadcast_arrays(np.asarray(Mt, np.float64), np.asarray(Bt, np.float64))
    return _sample(problem, NODES).cost(Mt.ravel(), Bt.ravel()).reshape(Mt.shape)


def optimize_impedance(problem: ImpedanceProblem) -> ImpedanceOptimum:
    """Find the global minimum of the cost over the stable admittances within the bounds.

    A scan over the whole box (with fewer frequencies, dense towards small Mt and in log Bt)
    finds the best Bt of every Mt, and the best local minima along that valley; a pattern search
    with the full cost refines each of them, and moves before it shrinks, so that a minimum
    away from its start is still reached. The search is deterministic. An optimum on a bound is
    returned exactly as the bound; stable is Hurwitz at the nominal stiffness.
    """
    objective = objective_of(problem, NODES)
    found = refine(objective, _scan(problem), _STEP_TOLERANCE)
    u, v, costs = snap(objective, found.u, found.v)
    best = int(np.argmin(costs))
    Mt, Bt = admittance_at(problem, u[best : best + 1], v[best : best + 1])
    return ImpedanceOptimum(
        Mt=float(Mt[0]),
        Bt=float(Bt[0]),
        cost=float(costs[best]),
        evaluations=found.evaluations + 4 * len(u),
    )


@dataclass(frozen=True, eq=False)
class _Samples:
    """The part of the cost that depends on the frequency only."""

    omega: FloatArray
    real: FloatArray
    imag: FloatArray
    target: FloatArray
    drawn: FloatArray
    weights: tuple[float, float]

    def cost(self, Mt: FloatArray, Bt: FloatArray) -> FloatArray:
        """Evaluate in blocks that stay in the processor's cache."""
        starts = range(0, len(Mt), _BLOCK)
        parts = [self._block(Mt[i : i + _BLOCK, None], Bt[i : i + _BLOCK, None]) for i in starts]
        return np.concatenate(parts) if parts else np.empty(0)

    def _block(self, Mt: FloatArray, Bt: FloatArray) -> FloatArray:
        reactance = Mt * self.omega - self.drawn
        below = (reactance + self.imag) ** 2 + (Bt + self.real) ** 2
        squared = (reactance**2 + Bt**2) / below  # |L|^2, and |Zdisp| = |G Ze| |L|
        displayed = np.abs(self.target - 0.5 * np.log10(squared)).mean(axis=1)
        robust = np.sqrt(squared).mean(axis=1)
        return np.asarray(self.weights[0] * displayed + self.weights[1] * robust)


def _sample(problem: ImpedanceProblem, nodes: int) -> _Samples:
    omega: FloatArray = (np.arange(nodes, dtype=np.float64) + 0.5) * (problem.bandwidth / nodes)
    # That of a hand with a mass is improper, so it is no transfer function.
    above, below = (np.polyval(part, 1j * omega) for part in problem.loop.contact.impedance)
    forward = frequency_response(problem.loop.motion, omega) * above / below
    filtered = forward / np.polyval(problem.loop.lags, 1j * omega)
    return _Samples(
        omega=omega,
        real=filtered.real,
        imag=filtered.imag,
        target=np.log10(problem.desired / np.abs(forward)),
        drawn=problem.loop.Kt / omega,
        weights=(problem.weight_displayed, problem.weight_sensitivity),
    )


def admittance_at(
    problem: ImpedanceProblem, u: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Map the unit square onto the bounds of Mt and Bt, corners exactly onto corners.

    A u below the search's tolerance counts as the bound itself.
    """
    (low, high), (least, most) = problem.mass_bounds, problem.damping_bounds
    u = np.where(u < _STEP_TOLERANCE, 0.0, u)
    Mt = np.where(u >= 1, high, low + (high - low) * u**3)
    Bt = np.where(v >= 1, most, least * (most / least) ** v)
    return Mt, Bt


def objective_of(problem: ImpedanceProblem, nodes: int) -> Objective:
    """Return the cost over the unit square; infinite where the nominal loop is not stable."""
    samples, stabilizing = (
        _sample(problem, nodes),
        problem.stable or partial(stabilizes, problem.loop),
    )

    def stable_cost(u: FloatArray, v: FloatArray) -> FloatArray:
        Mt, Bt = admittance_at(problem, u, v)
        stable = stabilizing(Mt, Bt)
        costs = np.full(len(Mt), np.inf)
        costs[stable] = samples.cost(Mt[stable], Bt[stable])
        return costs

    return stable_cost


def _scan(problem: ImpedanceProblem) -> Points:
    """Return the starts of the search: local minima of a scan, and those along its valley."""
    bounds = problem.mass_bounds, problem.damping_bounds
    shape = tuple(
        1 if low == high else count for (low, high), count in zip(bounds, _SCAN, strict=True)
    )
    u, v = np.meshgrid(*(np.linspace(0, 1, count) for count in shape), indexing="ij")
    costs = objective_of(problem, _SCAN_NODES)(u.ravel(), v.ravel()).reshape(shape)
    rows = np.flatnonzero(np.isfinite(costs).any(axis=1))
    if not len(rows):
        raise DesignError(
            f"no admittance with Mt in {list(problem.mass_bounds)} {unit('kg m^2')} and Bt in "
            f"{list(problem.damping_bounds)} {unit('N m s/rad')} keeps the loop stable at "
            f"{problem.loop.contact.stiffness:.6g} {unit('N m/rad')}",
            remedy="raise the upper bound of Bt or lower the lower bound of Mt",
            at=("Bt",),
        )
    spacing = [1 / (count - 1) if count > 1 else 0.0 for count in shape]
    valley = _sharpen(problem, u[rows, 0], v[0, np.argmin(costs[rows], axis=1)], spacing[1])
    cells = np.flatnonzero(local_minima(costs))
    known = np.abs(u.ravel()[cells, None] - valley.u) + np.abs(v.ravel()[cells, None] - valley.v)
    cells = cells[known.min(axis=1) > max(spacing)]
    cells = cells[np.argsort(costs.ravel()[cells], kind="stable")][:_STARTS]
    return Points(
        u=np.r_[valley.u, u.ravel()[cells]],
        v=np.r_[valley.v, v.ravel()[cells]],
        step=np.array(spacing) / 4,
        slope=np.r_[valley.slope, np.zeros(len(cells))],
        evaluations=costs.size + valley.evaluations,
    )


def _sharpen(problem: ImpedanceProblem, u: FloatArray, v: FloatArray, spacing: float) -> Points:
    """Refine the valley ``Bt(Mt)`` of the scan and pick its lowest local minima."""
    objective = objective_of(problem, _VALLEY_NODES)
    step = np.array([0.0, spacing])
    valley = refine(objective, Points(u, v, step, np.zeros(len(u)), 0), _VALLEY_TOLERANCE)
    costs = objective(valley.u, valley.v)
    minima = np.flatnonzero(local_minima(costs[:, None]))
    minima = minima[np.argsort(costs[minima], kind="stable")][:_STARTS]
    slope = np.gradient(valley.v, valley.u) if len(u) > 1 else valley.slope
    return Points(
        u=valley.u[minima],
        v=valley.v[minima],
        step=step,
        slope=slope[minima],
        evaluations=valley.evaluations + len(costs),
    )
