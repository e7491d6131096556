"""Where the search for parameters begins, and the box that it stays in.

Every law is linear in its stiffnesses and dampings once its time constant or exponent is fixed:
a scan over that one number, with a linear fit at each, finds all valleys of the cost.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from nrs_design.identification.numeric import Array, beyond, column_sizes
from nrs_design.identification.tissue.trial import Trial
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
from nrs_design.models.contact.relaxation import Relaxation

_SCAN = 9
_EXPONENTS = 3
# A coefficient that the linear fit would make zero or negative starts at this part of its scale.
_FLOOR = 1e-3
# Box around the scale of a stiffness; a damping may also act over one step or the whole record.
_STIFFNESS_BOX = 1e4
_SHORTEST, _LONGEST = 1e-4, 1e3


def scan(
    kind: type[AbstractContactLaw], trial: Trial, offsets: Array
) -> Iterator[AbstractContactLaw]:
    """Yield candidates for the start of a search."""
    basis, used = np.linalg.qr(offsets)[0], trial.used

    def linear(*regressors: Array) -> tuple[float, ...]:
        X = np.column_stack([regressor[used] for regressor in regressors])
        return _linear(trial.measured, X, basis)

    return _SCANS[kind](trial, linear)


# Fits positive factors of regressors over all samples to the force.
Linear = Callable[..., tuple[float, ...]]


def _elastic(trial: Trial, linear: Linear) -> Iterator[Elastic]:
    yield Elastic(*linear(trial.motion.deflection))


def _kelvin_voigt(trial: Trial, linear: Linear) -> Iterator[KelvinVoigt]:
    yield KelvinVoigt(*linear(trial.motion.deflection, trial.motion.velocity))


def _maxwell(trial: Trial, linear: Linear) -> Iterator[Maxwell]:
    for tau in _time_constants(trial):
        (k,) = linear(Relaxation(trial.motion, tau).y)
        yield Maxwell(k, k * tau)


def _kelvin_boltzmann(trial: Trial, linear: Linear) -> Iterator[KelvinBoltzmann]:
    for tau in _time_constants(trial):
        eta1, arm = linear(trial.motion.deflection, Relaxation(trial.motion, tau).y)
        yield KelvinBoltzmann.from_eta(eta1, (eta1 + arm) * tau, tau)


def _hunt_crossley(trial: Trial, linear: Linear) -> Iterator[HuntCrossley]:
    for phi in np.linspace(LEAST_EXPONENT, LARGEST_EXPONENT, _EXPONENTS).tolist():
        power = np.maximum(trial.motion.deflection, 0.0) ** phi
        rho, lam = linear(power, power * trial.motion.velocity)
        yield HuntCrossley(rho, lam, phi)


Scan = Callable[[Trial, Linear], Iterator[AbstractContactLaw]]
_SCANS: Mapping[type[AbstractContactLaw], Scan] = {
    Elastic: _elastic,
    KelvinVoigt: _kelvin_voigt,
    Maxwell: _maxwell,
    KelvinBoltzmann: _kelvin_boltzmann,
    HuntCrossley: _hunt_crossley,
}


def box(kind: type[AbstractContactLaw], trial: Trial) -> tuple[Array, Array]:
    """Return the bounds of the logarithms of the parameters.

    They are so wide that only a parameter which the record does not determine reaches them; the
    exponent is kept between 1.1 and 1.3 as in thesis 2.5.
    """
    k = trial.span / float(np.ptp(trial.deflection))
    stiffness = (k / _STIFFNESS_BOX, k * _STIFFNESS_BOX)
    damping = (k * trial.step * _SHORTEST, k * trial.duration * _LONGEST)
    reach = float(np.max(np.abs(trial.deflection)))
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


def _time_constants(trial: Trial) -> list[float]:
    return list(map(float, np.geomspace(2 * trial.step, 5 * trial.duration, _SCAN)))


def _linear(force: Array, X: Array, basis: Array) -> tuple[float, ...]:
    """Fit positive coefficients: least squares, what comes out too small is lifted."""
    force, X = beyond(basis, force), beyond(basis, X)
    size = column_sizes(X)
    scaled = np.linalg.lstsq(X / size, force, rcond=None)[0]
    floor = _FLOOR * float(np.linalg.norm(force))
    if (scaled < floor).any() and len(size) > 1:
        # Without the offending terms, as a nonnegative fit would have it.
        alone = (X / size).T @ force
        scaled = np.where(scaled < floor, 0.0, np.maximum(alone, floor))
    return tuple((np.maximum(scaled, floor) / size).tolist())
