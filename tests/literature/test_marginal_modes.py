"""Single modes on the border of stability, where an eigenvalue in floating point may fall on
either side.

[[0, 1], [-1, 0]] rotates: eigenvalues +-j. -(0.6, 0.8)'(0.6, 0.8) is singular in decimals, but
its nearest doubles are not.
"""

import pytest

from .known import settle


@pytest.mark.parametrize("name", ["rotation", "decimal-singular"])
def test_marginal_mode_is_refuted(name):
    assert settle(name).evidence.steps[0][0] == "m0"
