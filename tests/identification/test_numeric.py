"""Steps of a search."""

import numpy as np

from nrs_design.identification.numeric import limited_step


def test_a_long_step_keeps_its_direction():
    step = limited_step(np.array([4.0, -0.2]), np.array([2.0, 0.5]))
    assert step.tolist() == [2.0, -0.1]
    # A short one stays.
    assert limited_step(np.array([0.5, -0.2]), np.array([2.0, 0.5])).tolist() == [0.5, -0.2]
