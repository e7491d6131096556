"""J. C. Geromel and P. Colaneri, "Stability and stabilization of continuous-time switched linear
systems", SIAM Journal on Control and Optimization 45(5), 2006.

Stable with a dwell time of 2.76 s, unstable with one of 2.70 s, hence under arbitrary switching.
"""

from .known import never_contradict


def test_not_called_stable_under_arbitrary_switching():
    never_contradict("geromel-colaneri")
