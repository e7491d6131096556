"""The exponential of a matrix is SciPy's, also where the entries are far apart."""

import numpy as np
import pytest
from scipy import linalg

from nrs_design.models.exponential import expm
from tests.tables import rows


@pytest.mark.parametrize("A", rows(__file__, "test_it_is_that_of_scipy"))
def test_it_is_that_of_scipy(A):
    expected = linalg.expm(np.array(A))
    assert np.allclose(expm(np.array(A)), expected, rtol=1e-12, atol=1e-300)
