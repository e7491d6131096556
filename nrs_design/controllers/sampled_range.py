"""Where the coefficients of a sampled admittance lie while its gains are anywhere in a box."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import product

from nrs_design.controllers.laws import CompliantLaw
from nrs_design.controllers.sampled import UNIT, SampledAdmittance
from nrs_design.errors import DesignError
from nrs_design.spec.interval import Interval

# Below it, single precision keeps fewer digits.
_NORMAL = Fraction(1, 2**126)


def coefficient_ranges(
    law: CompliantLaw, gains: Mapping[str, Interval], period: Fraction, method: str
) -> dict[str, Interval]:
    """Return where a and ``c = b/(1 - a)`` lie; without inertia ``c = b`` alone.

    Exact or by Euler's method, a falls with Bt and rises with Mt, and so it does when it is
    rounded: its ends are at corners. Each of a and b is rounded once, by at most 2^-24 of its size,
    which moves c away from 1/Bt by less than eight times that share of it over ``1 - a``, as long
    as all this is small.

    Parameters
    ----------
    law : CompliantLaw
        An admittance.
    gains : mapping
        Intervals of Mt and Bt; others are left alone.
    period : Fraction
        In s.
    method : {"exact", "euler"}
        By which the law is discretized.

    Returns
    -------
    dict of str to Interval
        Empty where Mt and Bt are points.

    Raises
    ------
    DesignError
        If single precision loses a coefficient.
    """
    Mt, Bt = gains["Mt"], gains["Bt"]
    if Mt.low == Mt.high and Bt.low == Bt.high:
        return {}
    corners = product((Mt.low, Mt.high), (Bt.low, Bt.high))
    held = [law.of({"Mt": m, "Bt": b}).sampled(period, method) for m, b in corners]
    ends = [end for end in held if isinstance(end, SampledAdmittance)]
    least, most = min(end.b for end in ends), max(end.b for end in ends)
    kept = [end.a for end in ends if end.a is not None]
    if not kept:
        return {"c": Interval(least, least, most)}
    low, high = min(kept), max(kept)
    share = _share(low, high, ends)
    least, most = (1 - share) / Bt.high, (1 + share) / Bt.low
    return {"a": Interval(low, low, high), "c": Interval(least, least, most)}


def _share(low: Fraction, high: Fraction, ends: Sequence[SampledAdmittance]) -> Fraction:
    """Return how far c is from 1/Bt at most, over its size."""
    if high < 1 and min(end.b for end in ends) >= _NORMAL:
        share = 8 * UNIT * max(-low, Fraction(1)) / (1 - high)
        if share <= Fraction(1, 16):
            return share
    raise DesignError(
        "somewhere in the ranges of its gains, single precision loses a coefficient of an "
        "admittance",
        remedy="narrow the ranges of Mt and Bt, or sample with another period",
        at=("controllers",),
    )
