import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.robot.simulation.track import Encoder

ENCODER = Encoder(5.0, 8192)
angles = st.lists(st.floats(-2, 2), min_size=3, max_size=3).map(np.array)


@given(joints=angles)
def test_rounds_to_the_nearest_count(joints):
    count = 2 * np.pi / 8192
    read = ENCODER.read(joints)
    assert np.all(np.abs(read - 5 * joints) <= count / 2 * (1 + 1e-9))
    assert read / count == pytest.approx(np.round(read / count), abs=1e-9)
    assert np.array_equal(ENCODER.read(read / 5), read)
