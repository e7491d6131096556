"""The search for the parameters that leave the least squared errors."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nrs_design.identification.numeric import Array

Errors = Callable[[Array], Array]  # Of parameters, shape (p,): measured less fitted, shape (n,)

_STEPS = 100
# Of the squared errors; and of the parameters, in units of their scale.
_CONVERGED, _SETTLED = 1e-12, 1e-9


def search(
    errors: Errors,
    sensitivities: Errors,
    start: Array,
    scale: Array | float = 1.0,
    bounds: tuple[Array | float, Array | float] = (-np.inf, np.inf),
    converged: float = _CONVERGED,
) -> tuple[Array, bool]:
    """Return the parameters, and whether the search has settled.

    Sensitivities are of the fitted output, shape (n, p). A first step is of the size of the scale.
    """
    from scipy.optimize import least_squares

    size = float(np.linalg.norm(errors(start))) or 1.0
    low, high = ((np.asarray(end) - start) / scale for end in bounds)

    def missed(z: Array) -> Array:
        return errors(start + scale * z) / size

    def slopes(z: Array) -> Array:
        return -sensitivities(start + scale * z) * scale / size

    found = least_squares(
        missed,
        np.zeros(len(start)),
        jac=slopes,
        bounds=(low, high),
        ftol=converged,
        xtol=_SETTLED,
        gtol=None,
        max_nfev=_STEPS,
    )
    return start + scale * np.asarray(found.x, float), bool(found.success)
