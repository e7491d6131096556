"""What the range in a spec holds: the mean, most specimens, or the next one."""

import numpy as np
import pytest

from nrs_design.identification.statistics import Estimate, tolerance_factor
from nrs_design.identification.tissue.ranges import spread_ranges

POINT = Estimate(1.0, 1.0, 1.0)


# One-sided factors for a share of 95 % with 95 % confidence, as tabulated (Owen 1968; ISO 16269-6).
@pytest.mark.parametrize(
    ("count", "factor"), [(2, 26.260), (3, 7.656), (5, 4.203), (10, 2.911), (30, 2.220)]
)
def test_tolerance_factors_of_the_tables(count, factor):
    assert tolerance_factor(count, share=0.9, confidence=0.9) == pytest.approx(factor, abs=1e-3)


def samples(seed, n, p=1):
    return np.random.default_rng(seed).standard_normal((n, p))


def inside(ranges, logs):
    return np.all(
        [(np.exp(x) >= r.low) & (np.exp(x) <= r.high) for r, x in zip(ranges, logs.T, strict=True)],
        axis=0,
    )


@pytest.mark.parametrize("count", [3, 8])
@pytest.mark.parametrize("p", [1, 2])
def test_a_prediction_holds_the_next_record(count, p):
    hits = [
        inside(spread_ranges("prediction", logs[:-1], [[POINT] * p] * count), logs[-1:])[0]
        for seed in range(1000)
        for logs in [samples(seed, count + 1, p)]
    ]
    # Bonferroni errs to the wide side.
    assert 0.93 < np.mean(hits) < 0.98


@pytest.mark.parametrize("count", [3, 8])
def test_a_tolerance_range_holds_its_share(count):
    from scipy.special import ndtr

    held = []
    for seed in range(1000):
        (found,) = spread_ranges("tolerance", samples(seed, count), [[POINT]] * count)
        held.append(ndtr(np.log(found.high)) - ndtr(np.log(found.low)) >= 0.95)
    assert np.mean(held) >= 0.95
