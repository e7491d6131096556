"""What a sampled admittance makes of white noise in the force that it takes."""

from __future__ import annotations

from math import exp, sqrt


def noise_gain(Mt: float, Bt: float, period: float, method: str) -> float:
    """Return the standard deviation of the velocity vm over that of the force samples.

    Of ``v+ = a v + b F`` with white F it is ``b/sqrt(1 - a^2)``; without mass ``1/Bt``.

    Parameters
    ----------
    Mt, Bt : float
        kg m^2 and N m s/rad; a spring is left out.
    period : float
        In s.
    method : {"exact", "euler"}
        How the admittance becomes a step.
    """
    if Mt == 0:
        return 1 / Bt
    step = Bt * period / Mt
    if method == "euler":
        # a = 1 - step and b = period/Mt; from a step of 2 on, it grows.
        return float("inf") if step >= 2 else sqrt(step / (2 - step)) / Bt
    a = exp(-step)
    return sqrt((1 - a) / (1 + a)) / Bt
