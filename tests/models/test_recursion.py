"""First-order recursions."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.models.recursion import run_first_order


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(-10, 10)), min_size=1, max_size=30))
def test_equals_the_loop(pairs):
    factors, inputs = np.array(pairs).T
    y = [0.0]
    for factor, value in pairs:
        y.append(factor * y[-1] + value)
    assert np.allclose(run_first_order(factors, inputs), y, rtol=1e-12, atol=1e-12)
