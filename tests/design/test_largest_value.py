"""The largest value of a decaying signal, by closed forms."""

import math

import numpy as np
import pytest

from nrs_design.design.largest_value import largest


@pytest.mark.parametrize("scale", [1.0, 1e3])
def test_a_critically_damped_bump(scale):
    """``t exp(-t)`` peaks at 1/e, and a signal that only falls at its start."""
    A = scale * np.array([[-1.0, 1.0], [0.0, -1.0]])
    poles = scale * np.array([-1.0 + 0j, -1.0 + 0j])
    assert largest(A, np.eye(2)[0], np.eye(2)[1], poles) == pytest.approx(math.exp(-1), rel=1e-9)
    assert largest(A, np.eye(2)[1], np.eye(2)[1], poles) == 1.0


def test_a_peak_between_samples_of_a_light_damping():
    """``exp(-z t) sin(w t)``: at ``tan(w t) = w/z``."""
    z, w = 0.05, 2.0
    A = np.array([[-z, w], [-w, -z]])
    t = math.atan2(w, z) / w
    wanted = math.exp(-z * t) * math.sin(w * t)
    found = largest(A, np.eye(2)[0], np.eye(2)[1], np.linalg.eigvals(A))
    assert found == pytest.approx(wanted, rel=1e-10)
