"""The thesis's loop G Ze H Y by its formulas, and what it bears by python-control: an oracle."""

import math
from types import SimpleNamespace

import control
import numpy as np

from nrs_design.design.impedance_optimum import characteristic_polynomials
from nrs_design.design.transfer import TransferFunction, frequency_response, to_control, trim


def loop_margins(loop, Mt, Bt):
    """Crossovers by python-control, peaks on a fine grid."""
    tf = open_loop(loop, Mt, Bt)
    gains, degrees, _, at_gain, at_phase, _ = control.stability_margins(
        to_control(tf), returnall=True
    )
    phases = [(math.radians(d), w) for d, w in zip(degrees, at_phase, strict=True) if w > 0]
    S = 1 / (1 + frequency_response(tf, np.geomspace(1e-2, 1e5, 400_001)))
    return SimpleNamespace(
        sensitivity_peak=max(1.0, np.abs(S).max()),
        gain_margin=min(
            # The pole of the integrator shows as a crossover at zero frequency.
            (g for g, w in zip(gains, at_gain, strict=True) if w > 0 and g > 1),
            default=math.inf,
        ),
        phase_margin=min((abs(phase) for phase, _ in phases), default=math.inf),
        # A delay only takes phase away: a lead of -10 degrees is lost after 350 more.
        delay_margin=min((phase % (2 * math.pi) / w for phase, w in phases), default=math.inf),
        disk_margin=min(2.0, 1 / np.abs(S - 0.5).max()),
    )


def open_loop(loop, Mt, Bt):
    """``G Ze H Y``."""
    numerator, _ = loop.forward
    return TransferFunction(tuple(numerator.tolist()), tuple(_free(loop, Mt, Bt).tolist()))


def displayed_impedance_at(loop, Mt, Bt, omega):
    """``Zdisp = G Ze / (1 + G Ze H Y)`` (thesis 6.3)."""
    forward = np.convolve(loop.forward[0], loop.lags)
    if not loop.Kt:
        return _over(loop, Mt, Bt, np.convolve(forward, trim((Mt, Bt))), omega)
    numerator = np.convolve(forward, trim((Mt, Bt, loop.Kt)))
    return _over(loop, Mt, Bt, numerator, omega) / (1j * np.asarray(omega))


def sensitivity(loop, Mt, Bt, omega):
    """``L = 1 / (1 + G Ze H Y)`` (thesis 6.5)."""
    return _over(loop, Mt, Bt, _free(loop, Mt, Bt), omega)


def closed_loop_polynomial(loop, Mt, Bt):
    """The characteristic polynomial, highest power first."""
    rows = characteristic_polynomials(loop, np.array(Mt), np.array(Bt))
    return np.asarray(trim(rows.tolist()))


def _over(loop, Mt, Bt, numerator, omega):
    closed = closed_loop_polynomial(loop, Mt, Bt)
    return frequency_response(TransferFunction(tuple(numerator), tuple(closed)), omega)


def _free(loop, Mt, Bt):
    return np.polyadd(np.convolve(loop.forward[1], trim((Mt, Bt))), loop.spring_part)
