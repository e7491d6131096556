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

from nrs_design.controllers.controller_design import ImpedanceOptimum
from nrs_design.design.pattern_search import TOLERANCE, Objective, lowest_on_square
from nrs_design.design.transfer import (
    BoolArray,
    FloatArray,
    TransferFunction,
    frequency_response,
    hurwitz,
    trim,
)
from nrs_design.errors import DesignError
from nrs_design.models.axis import unit
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
    def spring_part(self) -> FloatArray:
        """The part of the denominator of L from the spring: Kt times that of ``G Ze H``, over s."""
        return np.asarray(self.Kt * self.forward[1][:-1]) if self.Kt else np.zeros(1)


def stabilizes(loop: ImpedanceLoop, Mt: ArrayLike, Bt: ArrayLike) -> BoolArray:
    """Tell for which admittances the closed loop is Hurwitz (Mt and Bt broadcast)."""
    Mt, Bt = np.broadcast_arrays(np.asarray(Mt, np.float64), np.asarray(Bt, np.float64))
    return hurwitz(characteristic_polynomials(loop, Mt, Bt))


def characteristic_polynomials(loop: ImpedanceLoop, Mt: FloatArray, Bt: FloatArray) -> FloatArray:
    """Stack the characteristic polynomials; the leading entry is zero where Mt is."""
    contact, den = loop.forward
    zeros = np.zeros(len(den) + 1)
    zeros[-len(contact) :] = contact
    zeros[-len(loop.spring_part) :] += loop.spring_part
    inert, damped = np.append(den, 0.0), np.insert(den, 0, 0.0)
    return np.asarray(Mt[..., None] * inert + Bt[..., None] * damped + zeros)


# Midpoint rule over (0, bandwidth]. The absolute value in the cost has kinks, which spoil a
# Gauss rule; with 256 midpoints the cost is within 1e-6 of its integral on the published designs
# and the optimal Bt within 3e-4. With fewer the search looks for where to start.
NODES, _FEW_NODES = 256, 64
_BLOCK = 256
MISSED = 1e6  # Above every cost, so that a missed goal is worse than any cost


@dataclass(frozen=True)
class ImpedanceProblem:
    """Loop, bounds and weights of the choice of an admittance."""

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

    ``C = wD mean|log10 Zdes - log10|Zdisp|| + wR mean|L|`` over ``(0, bandwidth]``, by the midpoint
    rule with `NODES` frequencies; the sum of the thesis would depend on their number. Mt and Bt
    broadcast; stability is not checked.
    """
    Mt, Bt = np.broadcast_arrays(np.asarray(Mt, np.float64), np.asarray(Bt, np.float64))
    return _cost_function(problem, NODES)(Mt.ravel(), Bt.ravel()).reshape(Mt.shape)


def optimize_impedance(
    problem: ImpedanceProblem, violation: Objective | None = None
) -> ImpedanceOptimum:
    """Find the global minimum of the cost over the stable admittances within the bounds.

    Where a violation is given, of Mt and Bt, the cost is minimized where it is not positive, or
    else the violation: the cost is then `MISSED` at least. The search (`pattern_search`) is dense
    towards small Mt and in log Bt. An optimum on a bound is returned exactly as the bound; stable
    is Hurwitz at the nominal stiffness.
    """
    coarse, fine = (_objective(problem, nodes, violation) for nodes in (_FEW_NODES, NODES))
    mass, damping = problem.mass_bounds, problem.damping_bounds
    free = mass[0] != mass[1], damping[0] != damping[1]
    u, v, cost = lowest_on_square(coarse, fine, free)
    if not np.isfinite(cost):
        raise DesignError(
            f"no admittance with Mt in {list(problem.mass_bounds)} {unit('kg m^2')} and Bt in "
            f"{list(problem.damping_bounds)} {unit('N m s/rad')} keeps the loop stable at "
            f"{problem.loop.contact.stiffness:.6g} {unit('N m/rad')}",
            remedy="raise the upper bound of Bt or lower the lower bound of Mt",
            at=("Bt",),
        )
    (Mt,), (Bt,) = _map_admittance(problem, np.array([u]), np.array([v]))
    return ImpedanceOptimum(float(Mt), float(Bt), cost)


def _cost_function(problem: ImpedanceProblem, nodes: int) -> Objective:
    """Return the cost of arrays of Mt and Bt, by so many frequencies."""
    omega: FloatArray = (np.arange(nodes, dtype=np.float64) + 0.5) * (problem.bandwidth / nodes)
    # The impedance of a hand with a mass is improper, hence no transfer function.
    numerator, denominator = (
        np.polyval(part, 1j * omega) for part in problem.loop.contact.impedance
    )
    forward = frequency_response(problem.loop.motion, omega) * numerator / denominator
    filtered = forward / np.polyval(problem.loop.lags, 1j * omega)
    target, spring = np.log10(problem.desired / np.abs(forward)), problem.loop.Kt / omega

    def block_cost(Mt: FloatArray, Bt: FloatArray) -> FloatArray:
        reactance = Mt[:, None] * omega - spring
        magnitude = (reactance + filtered.imag) ** 2 + (Bt[:, None] + filtered.real) ** 2
        squared = (reactance**2 + Bt[:, None] ** 2) / magnitude  # |L|^2, and |Zdisp| = |G Ze| |L|
        displayed = np.abs(target - 0.5 * np.log10(squared)).mean(axis=1)
        robust = np.sqrt(squared).mean(axis=1)
        cost = problem.weight_displayed * displayed + problem.weight_sensitivity * robust
        return np.asarray(cost)

    def cost(Mt: FloatArray, Bt: FloatArray) -> FloatArray:
        # In blocks that stay in the processor's cache.
        starts = range(0, len(Mt), _BLOCK)
        parts = [block_cost(Mt[i : i + _BLOCK], Bt[i : i + _BLOCK]) for i in starts]
        return np.concatenate(parts) if parts else np.empty(0)

    return cost


def _map_admittance(
    problem: ImpedanceProblem, u: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Map the unit square onto the bounds of Mt and Bt, corners exactly onto corners.

    A u below the search's tolerance counts as the bound itself.
    """
    (low, high), (lowest, highest) = problem.mass_bounds, problem.damping_bounds
    u = np.where(u < TOLERANCE, 0.0, u)
    Mt = np.where(u >= 1, high, low + (high - low) * u**3)
    Bt = np.where(v >= 1, highest, lowest * (highest / lowest) ** v)
    return Mt, Bt


def _objective(problem: ImpedanceProblem, nodes: int, violation: Objective | None) -> Objective:
    """Return the cost over the unit square; infinite where the nominal loop is not stable."""
    cost = _cost_function(problem, nodes)
    stabilizing = problem.stable or partial(stabilizes, problem.loop)

    def objective(u: FloatArray, v: FloatArray) -> FloatArray:
        Mt, Bt = _map_admittance(problem, u, v)
        stable = stabilizing(Mt, Bt)
        Mt, Bt = Mt[stable], Bt[stable]
        costs, trial_costs = np.full(len(u), np.inf), cost(Mt, Bt)
        if violation is not None:
            missed = violation(Mt, Bt)
            # From 0 to 1, also where a corner is unstable and the violation is infinite.
            trial_costs = np.where(
                missed > 0, MISSED + 1 - 1 / (1 + np.maximum(missed, 0)), trial_costs
            )
        costs[stable] = trial_costs
        return costs

    return objective
