"""Initial guesses of the parameters, and their bounds.

Every law is linear in its stiffnesses and dampings once its time constant or exponent is fixed:
a scan over that one number, with a linear fit at each, finds all valleys of the cost.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nrs_design.identification.numeric import Array, beyond, column_sizes
from nrs_design.identification.tissue.trial import Trial
from nrs_design.models.contact import AbstractContactLaw
from nrs_design.models.contact.hunt_crossley import LARGEST_EXPONENT, LEAST_EXPONENT
from nrs_design.models.contact.law import DAMPING, STIFFNESS

# A coefficient that the linear fit would make zero or negative starts at this part of its scale.
_FLOOR = 1e-3
# Bounds relative to the scale of a stiffness, and of a damping over one step or the whole record.
_STIFFNESS_BOX = 1e4
_SHORTEST, _LONGEST = 1e-4, 1e3


def scan(
    kind: type[AbstractContactLaw], trial: Trial, offsets: Array
) -> Iterator[AbstractContactLaw]:
    """Yield candidates for the start of a search."""
    basis = np.linalg.qr(offsets)[0]
    force = beyond(basis, trial.measured)
    floor = _FLOOR * float(np.linalg.norm(force))

    def solve(*regressors: Array) -> tuple[float, ...]:
        """Fit positive coefficients: least squares, what comes out too small is lifted."""
        X = beyond(basis, np.column_stack([regressor[trial.used] for regressor in regressors]))
        size = column_sizes(X)
        scaled = np.linalg.lstsq(X / size, force, rcond=None)[0]
        if (scaled < floor).any() and len(size) > 1:
            # Without the offending terms, as a nonnegative fit would have it.
            alone = (X / size).T @ force
            scaled = np.where(scaled < floor, 0.0, np.maximum(alone, floor))
        return tuple((np.maximum(scaled, floor) / size).tolist())

    return kind.guesses(trial.motion, solve)


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
