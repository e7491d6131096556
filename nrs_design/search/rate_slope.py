"""Best decay rate of a common quadratic form, with its derivative by the modes (untrusted).

By the envelope theorem: forms and multipliers need not be found again for a small change. With W
the dual variable of the inequality F of each edge, the margin changes by the sum of
``trace(W dF)``, whether modes or the rate change; where it stays zero, the rate makes up for the
modes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, log, sqrt

import numpy as np
from numpy.linalg import LinAlgError
from numpy.typing import NDArray

from nrs_design.proof.channels import Output
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.drawing import Inequality, Solution
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.search.forms import DualSolution, FormsProgram
from nrs_design.search.graphs import draw_together
from nrs_design.search.invariant_ellipsoid import BoundProgram, Frame
from nrs_design.search.ladder import Facts
from nrs_design.search.rates import share_of
from nrs_design.search.work import Allowance

# Bracket of a rate, relative to its size; step of a difference, relative to the rate.
RESOLUTION, DIFFERENCE = 5e-4, 1e-5
# Resolution of a rate, relative to its distance from the required rate.
COARSE = 0.03
# Next step of the rate, relative to the last gain.
FURTHER = 1.5
# Modes are made to decay at least as a contraction to this share.
CALM = 0.999
# Distances below the best rate at which slopes are taken, relative to the rate.
DISTANCES = (0.0, 1e-4, 1e-3, 1e-2)
# Growth is looked at up to this many times the decay of the slowest mode.
FASTEST_GROWTH = 64.0
# Shares relative to the best share of a system nearby.
SHARE_FACTORS = (0.6, 1.0, 1.6)


@dataclass(frozen=True)
class RateSlope:
    """The best rate of a system, and how it changes with small changes of the modes."""

    rate: float  # In 1/s; of a contraction rho per step, (1 - rho) over the period
    _program: FormsProgram
    _dual: DualSolution
    _at: float  # As the program counts rates
    _per_rate: float  # Change of the margin for 1/s more

    def change(self, system: SwitchedSystem) -> float:
        """Return the change of the rate for a system nearby, in first order, 1/s."""
        edges = self._program.edges_at(system)
        nearby_sum = _weighted(self._program, edges, self._dual, self._at)
        sum_here = _weighted(self._program, self._program.edges, self._dual, self._at)
        return (sum_here - nearby_sum) / self._per_rate


def may_have_slope(system: SwitchedSystem) -> bool:
    """Tell whether one form for all modes is what a proof of a system could be."""
    facts = Facts.of(system)
    timed = facts.is_continuous() or system.sample_time is not None
    return facts.may_share_an_ellipsoid() and system.clock is None and timed


def rate_slope(
    system: SwitchedSystem,
    guess: float | None = None,
    allowance: Allowance | None = None,
    resolution: float = RESOLUTION,
    wanted: float | None = None,
) -> RateSlope | None:
    """Find the best rate of one form for all modes; negative if they are shown to grow no faster.

    For systems for which `may_have_slope` holds; None if floating point shows nothing. The rate, in
    1/s, is bracketed to a share, `resolution`, of the guess or of the fastest decay of a mode; one
    that is far from `wanted` less closely.
    """
    allowance = allowance or Allowance()
    with floats_in_silence():
        program = _program(system, allowance)
        if program is None:
            return None
        limit = Family.of(system).limit
        best = _best(program, limit, guess, resolution, allowance, wanted)
        if best is None:
            return None
        # The slope of a vanishing margin is noise.
        for distance in DISTANCES:
            shifted_rate = _program_rate(best - distance * max(abs(best), resolution), program)
            dual = program.solve_dual(shifted_rate, allowance)
            per_rate = 0.0 if dual is None else _per_rate(program, dual, shifted_rate)
            if dual is not None and per_rate < 0:
                return RateSlope(best, program, dual, shifted_rate, per_rate)
    return None


def _program(system: SwitchedSystem, allowance: Allowance) -> FormsProgram | None:
    """Return the program of one form for all modes; None beyond floating point."""
    family = Family.of(system, allowance)
    if not np.isfinite(family.limit):
        return None
    calm = replace(family, matrices=_calmed(family))
    drawing = draw_together(calm, 1, lost=system.contact is not None)
    return FormsProgram(drawing) if drawing.is_finite else None


def _calmed(family: Family) -> NDArray[np.float64]:
    """Return the modes, or all of them with as much more decay as makes them stable.

    Coordinates are chosen by the norms of the modes, and a mode that grows has none.
    """
    modes, limit = family.matrices, family.limit
    if family.system.time is Time.DISCRETE:
        return modes if limit < CALM else np.asarray(modes * (CALM / limit))
    slowest = (1 - CALM) * float(np.abs(np.linalg.eigvals(modes)).max())
    return (
        modes if limit > slowest else np.asarray(modes - (slowest - limit) * np.eye(modes.shape[1]))
    )


def _program_rate(rate: float, program: FormsProgram) -> float:
    """Return a rate in 1/s as the program counts it."""
    if program.time is Time.CONTINUOUS:
        return rate
    return 1 - rate * _period(program)


def _period(program: FormsProgram) -> float:
    period = program.drawing.system.sample_time
    assert period is not None, "as has been looked at"
    return float(period)


def _best(
    program: FormsProgram,
    limit: float,
    guess: float | None,
    resolution: float,
    allowance: Allowance,
    wanted: float | None,
) -> float | None:
    """Bracket the best rate, from the guess: forms for a rate show a better one themselves."""
    fastest = (1 - limit) / _period(program) if program.time is Time.DISCRETE else limit
    start = fastest / 2 if guess is None else guess
    size = max(abs(start), abs(fastest) / 16)
    low, high, step, rate = None, None, size / (4 if guess is None else 32), start
    while abs(rate) <= FASTEST_GROWTH * max(abs(fastest), abs(start)):
        solution = program.solve(_program_rate(rate, program), allowance)
        own_rate = -inf if solution is None else _shown_rate(program, solution)
        if own_rate > rate:
            low, step = own_rate, min(FURTHER * (own_rate - rate), 2 * step)
        else:  # A solution that does not show the rate has a margin within the error of the solver.
            high = rate
        if low is None:
            rate, step = rate - step, 2 * step
            continue
        close = max(resolution * size, 0.0 if wanted is None else COARSE * abs(low - wanted))
        if high is None:
            step = max(step, close)
            rate = low + step
        elif high - low > close:
            rate = min(low + max(step, close), (low + high) / 2)
            step /= 2
        else:
            return low
    return low


def _shown_rate(program: FormsProgram, solution: Solution) -> float:
    """Return the rate in 1/s that forms show; none where they are singular in floating point."""
    try:
        rate = program.own_rate(solution)
    except LinAlgError:
        return -inf
    return rate if program.time is Time.CONTINUOUS else (1 - rate) / _period(program)


def _weighted(
    program: FormsProgram, edges: Sequence[Inequality], dual: DualSolution, rate: float
) -> float:
    """Return the sum of ``trace(W F)`` of some edges, with F as the program states it."""
    factors, total = program.factors(rate), 0.0
    for k, W in dual.duals.items():
        edge, solution = edges[k], dual.solution
        form = program.decrease(edge, solution, solution.vanishing[k], rate)
        total += float(np.sum(W * (form if edge.is_flow else factors[k] * form)))
    return total


def _per_rate(program: FormsProgram, dual: DualSolution, rate: float) -> float:
    """Return the change of the margin for 1/s more."""
    step = DIFFERENCE * max(abs(rate), RESOLUTION)
    ends = (_weighted(program, program.edges, dual, rate + side) for side in (-step, step))
    lower, upper = ends
    change = (upper - lower) / (2 * step)
    return change if program.time is Time.CONTINUOUS else -_period(program) * change


@dataclass(frozen=True)
class ForceSlope:
    """The least bound that is found, and how it changes with small changes of the modes."""

    level: float  # SI units of the output
    share: float  # Share of the disturbances; a guess for systems nearby
    _output: Output
    _frame: Frame  # Which stays for small changes
    _allowance: Allowance

    def change(self, system: SwitchedSystem) -> float:
        """Return the change of the logarithm of the bound for a system nearby."""
        with floats_in_silence():
            program = BoundProgram.around(system, system.channels, self._output, self._frame)
            found = program.solve(self.share, self._allowance)
        if found is None:
            return 0.0
        return log(self._frame.level * sqrt(found.last) / self.level)


def force_slope(
    system: SwitchedSystem, output: Output, allowance: Allowance, share: float | None = None
) -> ForceSlope | None:
    """Find the least bound on an output under all disturbances at once, but for roundings.

    `share` was the best of a system nearby. None if no bound is found in floating point.
    """
    with floats_in_silence():
        try:
            frame = Frame.of(system, system.channels, output)
        except LinAlgError:  # A mode that grows has no norm.
            return None
        if frame is None:
            return None
        program = BoundProgram.around(system, system.channels, output, frame)
        limit = Family.of(system).limit
        top, levels = share_of(limit, system.time), {}
        for nearby_share in (share * factor for factor in SHARE_FACTORS if share is not None):
            if nearby_share < top and (found := program.solve(nearby_share, allowance)) is not None:
                levels[nearby_share] = found.last
        best = min(levels, key=lambda one: levels[one], default=None)
        if best is None:
            least_level, best = program.best_share(limit, system.time, allowance)
        else:
            least_level = levels[best]
    if not isfinite(least_level):
        return None
    return ForceSlope(frame.level * sqrt(least_level), best, output, frame, allowance)
