"""One law fitted to one record: the simulated force against the measured one."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.datasets import TissueRecord
from nrs_design.identification.rounding import rounding_scatter
from nrs_design.identification.statistics import Estimate, Uncertainty, uncertainty
from nrs_design.identification.tissue.doubts import doubts
from nrs_design.identification.tissue.starts import box, scan
from nrs_design.models.contact import AbstractContactLaw, Motion

Array = NDArray[np.float64]

STARTS = 3
# Samples that suffice to find the right valley.
COARSE = 20_000
# Starts whose costs end within this factor of the best one have found the same valley.
_SAME = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class RecordFit:
    """A law that fits a record best, and how well it is known.

    Parameters
    ----------
    record : TissueRecord
        The data.
    law : AbstractContactLaw
        With the fitted parameters.
    uncertainty : Uncertainty
        Of the logarithms of the parameters.
    rmse : float
        Root of the mean squared force error, in N (N m).
    agreeing, starts : int
        How many searches there were, and how many of them ended here.
    doubts : tuple of str
        Why the record may not determine the parameters.
    """

    record: TissueRecord
    law: AbstractContactLaw
    uncertainty: Uncertainty
    rmse: float
    agreeing: int
    starts: int
    doubts: tuple[str, ...]

    @property
    def estimates(self) -> tuple[Estimate, ...]:
        """The parameters with their 95 % intervals."""
        return self.uncertainty.estimates(np.log(self.law.values))

    @property
    def aic(self) -> float:
        """Akaike's criterion ``n log(SSE/n) + 2 (p + 1)``."""
        return self._fidelity + 2 * self._count

    @property
    def bic(self) -> float:
        """Schwarz's criterion ``n log(SSE/n) + (p + 1) log n``."""
        return self._fidelity + self._count * float(np.log(len(self.record.force)))

    @property
    def _fidelity(self) -> float:
        return 2 * len(self.record.force) * float(np.log(max(self.rmse, np.finfo(float).tiny)))

    @property
    def _count(self) -> int:
        """Parameters, and the variance of the noise."""
        return len(self.law.values) + 1


def fit_record(kind: type[AbstractContactLaw], record: TissueRecord) -> RecordFit:
    """Fit a law by output error.

    Minimizes the squared difference of measured and simulated force over the logarithms of the
    parameters. Simulation and derivatives are exact for a piecewise linear deflection; the force
    is never differentiated.

    Parameters
    ----------
    kind : type
        One of `nrs_design.models.contact.LAWS`.
    record : TissueRecord
        n samples.
    """
    bounds, coarse = box(kind, record), _thin(record)
    candidates = sorted(scan(kind, coarse), key=lambda law: rmse(law, coarse))[:STARTS]
    ends = [_search(kind, coarse, law, bounds) for law in candidates]
    costs = np.array([rmse(law, coarse) ** 2 for law in ends])
    best = int(np.argmin(costs))
    law = ends[best] if coarse is record else _search(kind, record, ends[best], bounds)
    known = _uncertainty(law, record)
    return RecordFit(
        record=record,
        law=law,
        uncertainty=known,
        rmse=rmse(law, record),
        agreeing=int(np.sum(costs <= costs[best] * (1 + _SAME))),
        starts=len(ends),
        doubts=doubts(law, record, known, bounds),
    )


def _thin(record: TissueRecord) -> TissueRecord:
    """Return a shorter record to search in; only the last search needs every sample."""
    every = -(-len(record.force) // COARSE)
    if every == 1:
        return record
    motion = Motion(record.motion.time[::every], record.motion.deflection[::every])
    return replace(record, motion=motion, force=record.force[::every])


def residuals(law: AbstractContactLaw, record: TissueRecord) -> Array:
    """Return measured less simulated force, shape (n,)."""
    return record.force - law.simulate(record.motion)


def rmse(law: AbstractContactLaw, record: TissueRecord) -> float:
    """Return the root of the mean squared force error."""
    return float(np.sqrt(np.mean(residuals(law, record) ** 2)))


def _uncertainty(law: AbstractContactLaw, record: TissueRecord) -> Uncertainty:
    J = law.sensitivities(record.motion)
    stiffness = float(np.linalg.norm(record.force) / np.linalg.norm(record.motion.deflection))
    scatter = rounding_scatter(record.motion.deflection, J, stiffness)
    return uncertainty(J, residuals(law, record), scatter=scatter)


def _search(
    kind: type[AbstractContactLaw],
    record: TissueRecord,
    start: AbstractContactLaw,
    bounds: tuple[Array, Array],
) -> AbstractContactLaw:
    from scipy.optimize import least_squares

    scale = float(np.sqrt(np.mean(record.force**2)))
    low, high = bounds
    # The search needs room around its start.
    room = 1e-6 * (high - low)
    x0 = np.clip(np.log(start.values), low + room, high - room)

    def law_at(x: Array) -> AbstractContactLaw:
        return kind(*np.exp(x).tolist())

    def error(x: Array) -> Array:
        return -residuals(law_at(x), record) / scale

    def slope(x: Array) -> Array:
        return law_at(x).sensitivities(record.motion) / scale

    found = least_squares(
        error,
        x0,
        jac=slope,
        bounds=(low, high),
        xtol=1e-10,
        ftol=1e-12,
        gtol=1e-12,
    )
    return law_at(np.asarray(found.x))
