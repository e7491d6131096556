import numpy as np
import pytest
from nrs_design.search.decay import limit_rate, rate_of

from nrs_design.proof.mode import Time


def test_slowest_mode_limits_the_rate():
    modes = np.array([np.diag([-1.0, -2.0]), np.diag([-3.0, -0.5])])
    assert limit_rate(modes, Time.CONTINUOUS) == 0.5
    assert limit_rate(modes / 10, Time.DISCRETE) == pytest.approx(0.3)
    assert np.isnan(limit_rate(np.full((1, 2, 2), np.inf), Time.CONTINUOUS))


@pytest.mark.parametrize("rate", [0.1, 0.7])
def test_rate_shown_by_a_function(rate):
    Q = np.array([[2.0, 0.5], [0.5, 1.0]])
    assert rate_of(-rate * np.eye(2)[None], Q, Time.CONTINUOUS) == pytest.approx(rate)
    assert rate_of(rate * np.eye(2)[None], Q, Time.DISCRETE) == pytest.approx(rate)


def test_indefinite_functions_show_nothing():
    with pytest.raises(np.linalg.LinAlgError):
        rate_of(-np.eye(2)[None], np.diag([1.0, -1.0]), Time.CONTINUOUS)
