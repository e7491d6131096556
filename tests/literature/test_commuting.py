"""K. S. Narendra and J. Balakrishnan, "A common Lyapunov function for stable LTI systems with
commuting A-matrices", IEEE Transactions on Automatic Control 39(12), 1994.
"""

import numpy as np

from .known import known, settle


def test_the_pair_commutes():
    A, B = (np.array(mode.A.fractions()) for mode in known("commuting").system.modes)
    assert (A @ B == B @ A).all()


def test_the_rate_is_that_of_the_slower_mode():
    # Q = I shows it: both matrices are normal, with eigenvalues -1 +- j and -2 +- 3j.
    assert 0.999 < settle("commuting").evidence.rate <= 1
