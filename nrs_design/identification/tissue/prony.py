"""A Prony series: a spring beside several relaxing arms, as many as the data ask for.

Designs know one relaxation. The series says whether one is enough, and what is lost with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.identification.numeric import TINY, Array, beyond, column_sizes
from nrs_design.identification.tissue.offsets import measured_force, offset_columns, offset_names
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import Elastic, KelvinBoltzmann
from nrs_design.models.contact.law import AbstractLinearLaw
from nrs_design.models.contact.relaxation import Relaxation

MOST_TERMS = 3
_GRID = 12
_COARSE = 5_000
# Another term must lower BIC by this much.
_BIC = 10.0


@dataclass(frozen=True, slots=True, eq=False)
class Series:
    """A Prony series of one record."""

    record: str  # Its name
    rest: float  # Stiffness at rest, N/m (N m/rad)
    # arms, times: stiffness in N/m (N m/rad) and relaxation time in s of each arm, the fastest
    # first.
    arms: tuple[float, ...]
    times: tuple[float, ...]
    rmse: float  # Root of the mean squared force error, in N (N m)
    bic: tuple[float, ...]  # Of the series with one term, two, and so on
    reduced: AbstractLinearLaw | None  # The one relaxation that stands for all of them

    def text(self, *, rotational: bool) -> str:
        """Return it in words, with the law that it reduces to."""
        unit = "N m/rad" if rotational else "N/m"
        arms = ", ".join(
            f"{arm:.4g} {unit} in {tau:.4g} s"
            for arm, tau in zip(self.arms, self.times, strict=True)
        )
        text = f"{self.record}: Prony series of {len(self.arms)}: {self.rest:.4g} {unit} at rest"
        text += f", relaxing {arms}; RMSE {self.rmse:.4g}"
        if self.reduced is None:
            return text
        law = self.reduced
        values = zip(law.parameters(), law.values, strict=True)
        return f"{text}; as {law.name}: {', '.join(f'{name} = {v:.5g}' for name, v in values)}"


def fit_series(trial: Trial) -> Series:
    """Fit series of one to three terms, and choose by BIC."""
    thin = trial.thinned(_COARSE)
    fits = [_fit(thin, terms) for terms in range(1, MOST_TERMS + 1)]
    best = fits[0]
    for fit in fits[1:]:
        if fit.bic[0] < best.bic[0] - _BIC and min(fit.arms) > 0:
            best = fit
    return replace(best, bic=tuple(fit.bic[0] for fit in fits))


def _reduced(rest: float, arms: Array, times: Array) -> AbstractLinearLaw | None:
    """Return the one relaxation that stands for several; None if the arms vanish.

    It keeps the stiffness at rest, the stiffness that a sudden motion meets, and the impulse that
    the relaxation takes up, ``sum E_i tau_i``.
    """
    total = float(arms.sum())
    if not total > 0 or not rest > 0:
        return None
    tau = float(arms @ times) / total
    return KelvinBoltzmann.from_eta(rest, (rest + total) * tau, tau)


def _fit(trial: Trial, terms: int) -> Series:
    """Return the series of so many terms, with its own criterion only."""
    from scipy.optimize import least_squares

    low, high = np.log(trial.step), np.log(3 * trial.duration)

    def error_at(logs: Array) -> Array:
        return _solve(trial, np.exp(logs))[1]

    step = np.full(terms, 1e-4)
    ends = [
        least_squares(error_at, start, bounds=(low, high), diff_step=step, xtol=1e-8)
        for start in _starts(trial, terms, low, high)
    ]
    times = np.exp(min(ends, key=lambda end: end.cost).x)
    values, error = _solve(trial, times)
    n = len(error)
    count = 1 + 2 * terms + len(offset_names(Elastic, trial)) + terms * len(trial.unrested) + 1
    rmse = float(np.sqrt(np.mean(error**2)))
    bic = 2 * n * float(np.log(max(rmse, TINY))) + count * float(np.log(n))
    order = np.argsort(times)
    rest, arms, times = float(values[0]), values[1:][order], times[order]
    shown = tuple(arms.tolist()), tuple(times.tolist())
    return Series(trial.record.name, rest, *shown, rmse, (bic,), _reduced(rest, arms, times))


def _starts(trial: Trial, terms: int, low: float, high: float) -> Sequence[Array]:
    """Spread the times evenly, and take those that a nonnegative fit over a grid picks."""
    even = np.linspace(low, high, terms + 2)[1:-1]
    grid = np.linspace(low + 0.5, high - 0.5, _GRID)
    weights = _solve(trial, np.exp(grid))[0][1:]
    picked = np.sort(grid[np.argsort(weights)[-terms:]])
    return even, picked


def _solve(trial: Trial, times: Array) -> tuple[Array, Array]:
    """Return the nonnegative stiffnesses for given relaxation times, and the error."""
    from scipy.optimize import nnls

    used, motion = trial.used, trial.motion
    parts = [motion.deflection, *(Relaxation(motion, float(tau)).y for tau in times)]
    X = np.column_stack([np.where(trial.touching, part, 0.0)[used] for part in parts])
    basis = np.linalg.qr(_constants(trial, times))[0]
    force, X = beyond(basis, measured_force(trial)), beyond(basis, X)
    size = column_sizes(X)
    values = nnls(X / size, force)[0]
    return np.asarray(values / size), np.asarray(force - (X / size) @ values)


def _constants(trial: Trial, times: Array) -> Array:
    """Return what adds in proportion: offsets, and what the arms hold when a touch begins."""
    time = trial.motion.time
    columns = []
    for rows in trial.unrested:
        for tau in times:
            column = np.zeros(len(time))
            column[rows] = np.exp(-(time[rows] - time[rows.start]) / tau)
            columns.append(column[trial.used])
    offsets = offset_columns(offset_names(Elastic, trial), trial)[trial.used]
    return np.column_stack([offsets, *columns])
