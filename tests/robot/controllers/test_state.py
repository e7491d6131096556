import numpy as np

from nrs_design.robot.controllers import LawState


def test_no_rate_before_the_second_tick():
    error = np.array([[0.1, -0.2, 0.3]])
    assert np.array_equal(LawState().error_rate(error, 2e-3), np.zeros((1, 3)))
    assert np.allclose(LawState(error).error_rate(error + 4e-3, 2e-3), 2.0)
