"""The exponential of a matrix is SciPy's, also where the entries are far apart."""

import numpy as np
import pytest
from scipy import linalg

from nrs_design.models.exponential import expm


@pytest.mark.parametrize(
    "A",
    [
        [[0.0]],
        [[-28.5, 0.0], [1.0, 0.0]],
        [[-3.0, 4.0, 1e-9], [-4.0, -3.0, 0.0], [0.0, 1e6, -2e3]],
        [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]],
    ],
)
def test_it_is_that_of_scipy(A):
    expected = linalg.expm(np.array(A))
    assert np.allclose(expm(np.array(A)), expected, rtol=1e-12, atol=1e-300)
