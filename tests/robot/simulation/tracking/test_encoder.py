import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.robot.simulation.tracking import Encoder

ENCODER = Encoder(5.0, 8192)
angles = st.lists(st.floats(-2, 2), min_size=3, max_size=3).map(np.array)


def test_one_count_of_13_bits():
    # 360 deg/2^13 at the encoder, a fifth of it at the joint.
    count = np.radians(360 / 8192)
    read = ENCODER.read(np.array([0.49, 0.51, 1.51]) * count / 5)
    assert read == pytest.approx([0, count, 2 * count], abs=1e-15)


@given(joints=angles)
def test_rounds_to_the_nearest_count(joints):
    count = 2 * np.pi / 8192
    read = ENCODER.read(joints)
    assert np.all(np.abs(read - 5 * joints) <= count / 2 * (1 + 1e-9))
    assert read / count == pytest.approx(np.round(read / count), abs=1e-9)
    assert np.array_equal(ENCODER.read(read / 5), read)


@given(joints=angles)
def test_without_counts_nothing_is_rounded(joints):
    assert np.array_equal(Encoder(5.0, None).read(joints), 5 * joints)
