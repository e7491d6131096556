"""Covariance, intervals and whiteness."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from nrs_design.identification.reporting.view import estimate_numbers
from nrs_design.identification.statistics import (
    Estimate,
    independent,
    ljung_box,
    span,
    spread_ranges,
    student_quantile,
    tolerance_factor,
    uncertainty,
)


# Student's table.
@pytest.mark.parametrize(
    ("degrees", "quantile"), [(1, 12.706), (2, 4.303), (9, 2.262), (10**6, 1.960)]
)
def test_quantile(degrees, quantile):
    assert student_quantile(degrees) == pytest.approx(quantile, abs=5e-4)


def test_an_interval_is_shown_rounded_outwards():
    assert str(Estimate(399.948, 399.776, 400.1211)) == "399.95 [399.77, 400.13]"
    assert str(Estimate(2.0, 0.0, math.inf)) == "2 [0, inf]"
    assert str(Estimate(0.25, -1.000001, 1.0)) == "0.25 [-1.0001, 1]"


def test_unlimited_is_null_in_json():
    assert estimate_numbers(Estimate(2.0, 1.0, 3.0)) == {"value": 2.0, "low": 1.0, "high": 3.0}
    assert estimate_numbers(Estimate(2.0, 1.0, math.inf))["high"] is None


def test_a_range_of_one_number_is_written_once():
    assert span(0.005, 0.005 + 1e-12, "s") == "0.005 s"
    assert span(0.005, 0.006, "s") == "0.005 to 0.006 s"
    assert span(2, 3) == "2 to 3"


def test_interval_is_symmetric_in_the_logarithm():
    estimate = Estimate.build_from_log(math.log(2.0), math.log(3.0))
    assert (estimate.value, estimate.low, estimate.high) == pytest.approx((2.0, 2 / 3, 6.0))
    assert estimate.covers(6)
    assert not estimate.covers(6.01)
    assert estimate.scaled(2).high == pytest.approx(12.0)


@pytest.mark.parametrize("half", [math.inf, math.nan, 1e4])
def test_an_unknown_parameter_has_no_bounds(half):
    estimate = Estimate.build_from_log(0.0, half)
    assert (estimate.low, estimate.high) == (0.0, math.inf)


def test_classical_covariance_of_white_residuals():
    rng = np.random.default_rng(1)
    J = rng.normal(size=(400, 2))
    e = rng.normal(size=400)
    known = uncertainty(J, e)
    expected = (e @ e) / 398 * np.linalg.inv(J.T @ J)
    assert known.degrees == 398
    assert known.covariance == pytest.approx(expected, rel=1e-9)


def test_colored_residuals_widen_the_interval():
    rng = np.random.default_rng(2)
    noise = np.convolve(rng.normal(size=2100), np.ones(100) / 10, "valid")[:2000]
    J = np.ones((2000, 1))
    known = uncertainty(J, noise - noise.mean())
    assert known.whiteness < 1e-6
    classical = noise.std() / math.sqrt(2000)
    # The mean of 2000 samples with a memory of 100 scatters as 20 independent ones would.
    assert 5 < known.errors[0] / classical < 20
    assert known.degrees == 11


def test_a_parameter_without_effect_is_unknown():
    rng = np.random.default_rng(3)
    J = np.column_stack([np.ones(200), np.zeros(200)])
    known = uncertainty(J, rng.normal(size=200))
    assert known.errors[0] < 0.1
    assert known.errors[1] > 1e3


def test_whiteness_is_uniform_for_white_noise_only():
    p = [ljung_box(np.random.default_rng(seed).normal(size=500)) for seed in range(200)]
    assert 0.4 < np.mean(p) < 0.6
    assert np.mean(np.array(p) < 0.05) < 0.1
    # And a drift is seen.
    assert ljung_box(np.linspace(-1, 1, 100)) < 1e-6
    assert ljung_box(np.zeros(100)) == 1.0


def test_errors_that_are_alike_count_less():
    """Of n samples with correlation r from one to the next, n (1 - r)/(1 + r) tell about a mean."""
    white = np.random.default_rng(5).normal(size=20000)
    assert independent(white) == pytest.approx(20000, rel=0.03)
    assert independent(lfilter([1.0], [1.0, -0.8], white)) == pytest.approx(20000 / 9, rel=0.05)
    assert independent(np.zeros(10)) == 10


def test_hidden_scatter_adds():
    rng = np.random.default_rng(4)
    J, e = np.ones((100, 1)), rng.normal(size=100)
    more = uncertainty(J, e, scatter=np.array([[100.0]]))
    assert more.covariance[0, 0] == pytest.approx(uncertainty(J, e).covariance[0, 0] + 0.01)


def test_no_variance_is_negative_where_parameters_are_all_but_unknown():
    # Two columns that nearly agree and one without effect: the plain product of three matrices
    # rounds to a negative variance here, and its root is not a number.
    generator = np.random.default_rng(4)
    column = generator.standard_normal(400)
    almost = column + 1e-9 * generator.standard_normal(400)
    J = np.column_stack([column, almost, 1e-13 * generator.standard_normal(400)])
    scatter = J.T @ J
    found = uncertainty(J, 1e-3 * generator.standard_normal(400), scatter=scatter)
    assert np.all(np.diag(found.covariance) >= 0)
    assert np.all(np.isfinite(found.errors))


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
