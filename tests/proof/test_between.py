"""The modes between which a sampled loop is: by hand, and against motions with cut-off signals."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.between import between
from nrs_design.simulation.saturation import saturated_rates
from tests.proof.systems import matrix, pushed_away_in_steps, saturating_in_steps

HELD = [[Fraction(-1, 8), Fraction(1, 16)]]


def test_a_scalar_loop():
    """x+ = 3/2 x + sat(-x): its mode, and that with h x in the place of the signal."""
    loop = between(pushed_away_in_steps(), [[[Fraction(-5, 8)]]])
    assert [mode.A.fractions() for mode in loop.modes] == [[[Fraction(1, 2)]], [[Fraction(7, 8)]]]
    assert loop.saturation is None
    assert loop.contact is None


def test_what_is_rounded_goes_with_the_argument():
    """v+ = 11/10 v - k/10 delta + s: the rounding of s acts where s is the argument."""
    system = saturating_in_steps()
    loop = between(system, [HELD] * 3, rounding=True)
    (rounding,) = loop.roundings
    assert [c.fractions() for c in rounding.columns] == [[[1], [0]], [[0], [0]]] * 3
    # How large it is does not change.
    assert {tuple(row.fractions()[0]) for row in rounding.rows} == {(Fraction(3, 10_000), 0)}
    assert [len(loop.modes), len(loop.free)] == [4, 2]
    replaced = loop.modes[1].A.fractions()
    assert replaced == [
        [Fraction(11, 10) - Fraction(1, 8), Fraction(-1, 10) + Fraction(1, 16)],
        [Fraction(1, 10), 1],
    ]
    assert between(system, [HELD] * 3).roundings == ()


def test_every_rounding_keeps_its_own_column():
    system = saturating_in_steps()
    (item,), saturation = system.roundings, system.saturation
    other = replace(item, columns=(matrix([[0], [7]]),) * 3)
    (signal,) = saturation.signals
    # It does not act where s is the argument.
    signals = (replace(signal, errors=(matrix([[1, 0]]),) * 3),)
    both = replace(system, roundings=(item, other), saturation=replace(saturation, signals=signals))
    first, second = between(both, [HELD] * 3, rounding=True).roundings
    assert [c.fractions() for c in first.columns] == [[[1], [0]], [[0], [0]]] * 3
    assert [c.fractions() for c in second.columns] == [[[0], [7]]] * 6


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-0.12, 0.12), st.floats(-0.12, 0.12))
def test_a_cut_off_signal_is_a_mixture(v, delta, a, b):
    """Where h x is within its limit, the step is between those of the two modes."""
    system = saturating_in_steps()
    x = np.array([v, abs(delta)])
    h = np.array([a, b])
    if abs(h @ x) > 0.5:
        return
    held = [[[Fraction(a), Fraction(b)]]] * 3
    loop = between(system, held)
    found = saturated_rates(system)(np.tile(x, (3, 1)))
    for k in range(2):
        ends = [np.array(m.A.floats()) @ x for m in loop.modes[2 * k : 2 * k + 2]]
        low, high = sorted(end[0] for end in ends)
        assert low - 1e-9 <= found[k][0] <= high + 1e-9
        assert abs(found[k][1] - ends[0][1]) < 1e-12
