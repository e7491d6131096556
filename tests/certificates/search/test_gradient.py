"""The reference iteration of Liberzon and Tempo (2004)."""

import numpy as np
import pytest

from nrs_design.certificates.search.allowance import Allowance, NotAffordableError
from nrs_design.certificates.search.gradient import iterate_gradient

PAIR = np.array([[[-1.0, -1.0], [1.0, -1.0]], [[-1.0, -5.0], [0.2, -1.0]]])


def largest(A, Q):
    return np.linalg.eigvalsh(A.T @ Q + Q @ A + np.eye(len(Q)))[-1]


def test_converged_means_every_inequality_holds():
    result = iterate_gradient(PAIR)
    assert result.updates > 0
    assert np.linalg.eigvalsh(result.Q)[0] > 0
    assert all(largest(A, result.Q) <= 1e-9 for A in PAIR)


def test_one_mode_needs_no_update():
    result = iterate_gradient(PAIR[:1])
    assert result.updates == 0 or result.updates < 5
    np.testing.assert_allclose(result.Q, np.eye(2) / 2, atol=2e-2)


def test_shift_by_a_rate():
    assert iterate_gradient(PAIR, rate=0.05).Q is not None
    assert iterate_gradient(PAIR, rate=0.2, max_updates=2000).Q is None


@pytest.mark.parametrize("limit", [0, 10])
def test_gives_up(limit):
    worse = PAIR.copy()
    worse[1] = [[-1.0, -6.0], [1 / 6, -1.0]]
    result = iterate_gradient(worse, max_updates=limit)
    assert result.Q is None
    assert result.updates == limit


def test_it_stops_when_its_time_is_over():
    ticks = iter(range(1000))
    allowance = Allowance(10.0, clock=lambda: float(next(ticks)))
    worse = PAIR.copy()
    worse[1] = [[-1.0, -6.0], [1 / 6, -1.0]]
    with pytest.raises(NotAffordableError, match="stopped"):
        iterate_gradient(worse, allowance=allowance)
    assert next(ticks) < 20
