"""M. S. Branicky, "Multiple Lyapunov functions and other analysis tools for switched and hybrid
systems", IEEE Transactions on Automatic Control 43(4), 1998.

Two Hurwitz modes that are unstable under some switching.
"""

from nrs_design.proof.spectrum import is_stable

from .known import known, settle


def test_switching_between_the_two_is_refuted_by_a_periodic_signal():
    evidence = settle("branicky").evidence
    assert evidence.kind == "growing-sequence"
    assert {name for name, _ in evidence.steps} == {"m0", "m1"}


def test_each_mode_alone_is_hurwitz():
    system = known("branicky").system
    assert all(is_stable(mode.A, system.time) for mode in system.modes)
