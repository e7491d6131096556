"""Where the search for parameters begins, and the box that it stays in.

Every law is linear in its stiffnesses and dampings once its time constant or exponent is fixed:
a scan over that one number, with a linear fit at each, finds all valleys of the cost.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.datasets import TissueRecord
from nrs_design.models.contact import (
    AbstractContactLaw,
    Elastic,
    HuntCrossley,
    KelvinBoltzmann,
    KelvinVoigt,
    Maxwell,
)
from nrs_design.models.contact.hunt_crossley import LARGEST_EXPONENT, LEAST_EXPONENT
from nrs_design.models.contact.law import DAMPING, STIFFNESS
from nrs_design.models.contact.relaxation import relax

Array = NDArray[np.float64]

_SCAN = 9
_EXPONENTS = 3
# A coefficient that the linear fit would make zero or negative starts at this part of its scale.
_FLOOR = 1e-3
# Box around the scale of a stiffness; a damping may also act over one step or the whole record.
_STIFFNESS_BOX = 1e4
_SHORTEST, _LONGEST = 1e-4, 1e3


def scan(kind: type[AbstractContactLaw], record: TissueRecord) -> Iterator[AbstractContactLaw]:
    """Yield candidates for the start of a search."""
    return _SCANS[kind](record)


def _elastic(record: TissueRecord) -> Iterator[Elastic]:
    yield Elastic(*_linear(record.force, record.motion.deflection))


def _kelvin_voigt(record: TissueRecord) -> Iterator[KelvinVoigt]:
    yield KelvinVoigt(*_linear(record.force, record.motion.deflection, record.motion.velocity))


def _maxwell(record: TissueRecord) -> Iterator[Maxwell]:
    for tau in _time_constants(record):
        (k,) = _linear(record.force, relax(record.motion, tau)[0])
        yield Maxwell(k, k * tau)


def _kelvin_boltzmann(record: TissueRecord) -> Iterator[KelvinBoltzmann]:
    for tau in _time_constants(record):
        y, _ = relax(record.motion, tau)
        eta1, arm = _linear(record.force, record.motion.deflection, y)
        yield KelvinBoltzmann.from_eta(eta1, (eta1 + arm) * tau, tau)


def _hunt_crossley(record: TissueRecord) -> Iterator[HuntCrossley]:
    for phi in np.linspace(LEAST_EXPONENT, LARGEST_EXPONENT, _EXPONENTS).tolist():
        power = np.maximum(record.motion.deflection, 0.0) ** phi
        rho, lam = _linear(record.force, power, power * record.motion.velocity)
        yield HuntCrossley(rho, lam, phi)


Scan = Callable[[TissueRecord], Iterator[AbstractContactLaw]]
_SCANS: Mapping[type[AbstractContactLaw], Scan] = {
    Elastic: _elastic,
    KelvinVoigt: _kelvin_voigt,
    Maxwell: _maxwell,
    KelvinBoltzmann: _kelvin_boltzmann,
    HuntCrossley: _hunt_crossley,
}


def box(kind: type[AbstractContactLaw], record: TissueRecord) -> tuple[Array, Array]:
    """Return the bounds of the logarithms of the parameters.

    They are so wide that only a parameter which the record does not determine reaches them; the
    exponent is kept between 1.1 and 1.3 as in thesis 2.5.
    """
    k = _norm(record.force) / _norm(record.motion.deflection)
    step = float(np.median(record.motion.steps))
    stiffness = (k / _STIFFNESS_BOX, k * _STIFFNESS_BOX)
    damping = (k * step * _SHORTEST, k * record.duration * _LONGEST)
    reach = float(np.max(np.abs(record.motion.deflection)))
    power = reach ** (LEAST_EXPONENT - 1), reach**LARGEST_EXPONENT
    bounds = {
        STIFFNESS: stiffness,
        DAMPING: damping,
        "power stiffness": (stiffness[0] / power[0], stiffness[1] / power[0]),
        "power damping": (damping[0] / power[1], damping[1] / power[1]),
        "exponent": (LEAST_EXPONENT, LARGEST_EXPONENT),
    }
    low, high = np.log([bounds[kind] for kind in kind.kinds]).T
    return low, high


def _time_constants(record: TissueRecord) -> list[float]:
    step = float(np.median(record.motion.steps))
    return [float(tau) for tau in np.geomspace(2 * step, 5 * record.duration, _SCAN)]


def _linear(force: Array, *regressors: Array) -> tuple[float, ...]:
    """Fit positive coefficients: least squares, what comes out too small is lifted."""
    X = np.column_stack(regressors)
    size = np.maximum(np.linalg.norm(X, axis=0), np.finfo(float).tiny)
    scaled = np.linalg.lstsq(X / size, force, rcond=None)[0]
    floor = _FLOOR * _norm(force)
    if (scaled < floor).any() and len(size) > 1:
        # Without the offending terms, as a nonnegative fit would have it.
        alone = (X / size).T @ force
        scaled = np.where(scaled < floor, 0.0, np.maximum(alone, floor))
    return tuple(float(c) for c in np.maximum(scaled, floor) / size)


def _norm(values: Array) -> float:
    return float(np.linalg.norm(values))
