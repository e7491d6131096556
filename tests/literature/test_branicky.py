"""M. S. Branicky, "Multiple Lyapunov functions and other analysis tools for switched and hybrid
systems", IEEE Transactions on Automatic Control 43(4), 1998.

Two Hurwitz modes that are unstable under some switching.
"""

from nrs_design.certificates.check import is_stable

from .known import known, never_contradict


def test_switching_between_the_two_is_not_called_stable():
    never_contradict("branicky")


def test_each_mode_alone_is_hurwitz():
    system = known("branicky").system
    assert all(is_stable(mode, system.time) for mode in system.modes)
