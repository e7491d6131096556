"""What the thesis's loop G Ze H Y bears, by python-control and by bisection: an oracle."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from nrs_design.design.impedance import ImpedanceLoop, open_loop, stabilizes
from nrs_design.design.transfer import (
    FloatArray,
    TransferFunction,
    frequency_response,
    positive_roots,
    ratio_slope,
    squared_magnitude,
    to_control,
)
from nrs_design.errors import DesignError
from nrs_design.plotting import load_matplotlib


@dataclass(frozen=True)
class LoopMargins:
    """Margins of one stable impedance loop.

    Parameters
    ----------
    sensitivity_peak : float
        ``Ms``, the largest ``|1/(1 + G Ze Y)|`` over all frequencies.
    sensitivity_peak_frequency : float
        Where it is reached, rad/s; infinite where it is only approached.
    gain_margin : float
        Smallest factor above 1 on the loop gain that makes the loop unstable.
    gain_margin_low : float
        Largest factor below 1 that does; 0 if none does.
    phase_margin : float
        Smallest phase, of either sign, at a gain crossover that makes it unstable, rad.
    delay_margin : float
        Smallest dead time in the loop that makes it unstable, s.
    disk_margin : float
        Balanced disk margin ``1/max|S - 1/2|`` (skew 0), at most 2.
    stiffness_limit : float
        The value of `stiffness_limit`, N m/rad.

    Notes
    -----
    A margin that nothing limits is ``math.inf``.
    """

    sensitivity_peak: float
    sensitivity_peak_frequency: float
    gain_margin: float
    gain_margin_low: float
    phase_margin: float
    delay_margin: float
    disk_margin: float
    stiffness_limit: float


def loop_margins(loop: ImpedanceLoop, Mt: float, Bt: float) -> LoopMargins:
    """Compute the margins of the open loop ``G Ze Y``.

    Crossovers come from python-control. Peaks are taken at the exact stationary frequencies of
    the rational magnitude, so no margin depends on a frequency grid.

    Parameters
    ----------
    loop : ImpedanceLoop
        Motion loop and environment.
    Mt, Bt : float
        Admittance, kg m^2 and N m s/rad; Mt may be zero.

    Returns
    -------
    LoopMargins
        Margins, angles in rad.

    Raises
    ------
    DesignError
        If the closed loop is unstable, because its margins would say nothing.
    """
    tf = open_loop(loop, Mt, Bt)
    limit = stiffness_limit(loop, Mt, Bt)
    if not stabilizes(loop, Mt, Bt):
        raise DesignError(
            f"the loop with Mt = {Mt:.6g} kg m^2 and Bt = {Bt:.6g} N m s/rad is unstable at "
            f"{loop.contact.stiffness:.6g} N m/rad",
            remedy=f"it is stable below {limit:.6g} N m/rad; raise Bt or lower Mt",
            at=("Bt",),
        )
    peak, frequency = _sensitivity_peak(tf)
    low, high, phase, delay = _crossover_margins(tf)
    return LoopMargins(
        sensitivity_peak=peak,
        sensitivity_peak_frequency=frequency,
        gain_margin=high,
        gain_margin_low=low,
        phase_margin=phase,
        delay_margin=delay,
        disk_margin=_disk_margin(tf),
        stiffness_limit=limit,
    )


def stiffness_limit(loop, Mt, Bt):
    """The largest stiffness up to which the closed loop is Hurwitz, by bisection."""

    def stable(k):
        contact = loop.contact.at_stiffness(Fraction(k))
        return bool(stabilizes(replace(loop, contact=contact), Mt, Bt))

    low, high = 0.0, 1.0
    while stable(high):
        low, high = high, 2 * high
        if high > 1e9:
            return math.inf
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if stable(middle) else (low, middle)
    return low if low > 1e-9 else 0.0


def _sensitivity_peak(tf: TransferFunction) -> tuple[float, float]:
    """Return the largest ``|1/(1 + L)|`` and its frequency; it tends to 1 at high frequency."""
    closed = np.polyadd(tf.denominator, tf.numerator).tolist()
    omega = _stationary_frequencies(tf.denominator, closed)
    magnitude = np.abs(1 / (1 + frequency_response(tf, omega)))
    if not len(omega) or magnitude.max() <= 1:
        return 1.0, math.inf
    best = int(np.argmax(magnitude))
    return float(magnitude[best]), float(omega[best])


def _stationary_frequencies(numerator: Sequence[float], denominator: Sequence[float]) -> FloatArray:
    """Return the positive frequencies where ``|numerator/denominator|`` is stationary, rad/s."""
    slope = ratio_slope(squared_magnitude(numerator), squared_magnitude(denominator))
    return np.sqrt(positive_roots(slope))


def _crossover_margins(tf: TransferFunction) -> tuple[float, float, float, float]:
    """Return the low and high gain margin, the phase margin (rad) and the delay margin (s)."""
    load_matplotlib()
    import control

    gains, degrees, _, at_gain, at_phase, _ = control.stability_margins(
        to_control(tf), returnall=True
    )
    # The integrator's pole shows up as a spurious phase crossover at zero frequency.
    factors = [float(g) for g, w in zip(gains, at_gain, strict=True) if w > 0]
    phases = [
        (math.radians(float(d)), float(w)) for d, w in zip(degrees, at_phase, strict=True) if w > 0
    ]
    return (
        max((g for g in factors if g < 1), default=0.0),
        min((g for g in factors if g > 1), default=math.inf),
        min((abs(phase) for phase, _ in phases), default=math.inf),
        # A delay only takes phase away: a lead of -10 degrees is lost after 350 more.
        min((phase % (2 * math.pi) / w for phase, w in phases), default=math.inf),
    )


def _disk_margin(tf: TransferFunction) -> float:
    """Return the balanced disk margin; ``S - 1/2`` tends to 1/2 at both ends of the axis.

    python-control evaluates on a grid, which overstates the margin between two points: it is
    given the stationary frequencies themselves.
    """
    load_matplotlib()
    import control

    difference = np.polysub(tf.denominator, tf.numerator).tolist()
    closed = np.polyadd(tf.denominator, tf.numerator).tolist()
    omega = _stationary_frequencies(difference, closed)
    if not len(omega):
        return 2.0
    worst, _, _ = control.disk_margins(to_control(tf), omega, skew=0.0)
    return min(2.0, float(worst))
