from __future__ import annotations

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.simulation.rates import mode_rates
from tests.simulation.systems import system

# Narendra and Balakrishnan (1994), commuting modes.
COMMUTING = system([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])


def test_mode_rates_of_rotations_are_their_real_parts():
    assert mode_rates(COMMUTING, np.eye(2)) == pytest.approx([1.0, 2.0])


def test_mode_rates_in_discrete_time_are_singular_values():
    discrete = system([[0, 2], [0, 0]], [[0, 0], [0, 0]], time=Time.DISCRETE)
    assert mode_rates(discrete, np.eye(2)) == pytest.approx([2.0, 0.0])
