"""Crossings: none is missed, however short the time between two of them."""

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.simulation.flow import CHUNK, Flow

# Oscillator of 1 rad/s and a constant.
OSCILLATOR = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])


def flow(threshold, step=0.5, tolerance=1e-13):
    """Watch ``sin t - threshold``."""
    rows = np.array([[1.0, 0.0, -threshold]])
    return Flow(OSCILLATOR, rows, np.array([tolerance]), step)


def test_states_are_those_of_the_exponential():
    one = flow(2.0)
    z = np.array([0.3, -0.4, 1.0])
    for time in (0.0, 0.1, 0.37, one.h):
        assert one.advance(z, time) == pytest.approx(expm(OSCILLATOR * time) @ z, abs=1e-14)
    assert one.chunk(z, CHUNK)[-1] == pytest.approx(expm(OSCILLATOR * one.h * CHUNK) @ z, abs=1e-12)


@given(st.floats(-5.5, -1), st.booleans())
def test_a_pair_of_crossings_within_a_step_is_found(exponent, starts_at_peak):
    """The sine is above ``cos(d)`` for 2 d only, somewhere within the step."""
    d = 10.0**exponent
    one = flow(np.cos(d))
    begin = np.pi / 2 - (d * 1.5 if starts_at_peak else one.h / 3)
    z = np.array([np.sin(begin), np.cos(begin), 1.0])
    assert one.first_doubtful(one.chunk(z, 1), np.array([-1.0])) == 0
    found = one.first_crossing(z, one.h, np.array([-1.0]))
    assert found is not None
    # Near the peak the sine is flat: its rounding moves the crossing.
    assert begin + found == pytest.approx(np.pi / 2 - d, abs=1e-9 + 4e-13 / d)


@given(st.floats(-8, -1))
def test_a_near_miss_is_no_crossing(exponent):
    above = 1 + 10.0 ** (exponent - 3)
    one = flow(above)
    begin = np.pi / 2 - one.h / 3
    z = np.array([np.sin(begin), np.cos(begin), 1.0])
    assert one.first_crossing(z, one.h, np.array([-1.0])) is None


@settings(max_examples=30)
@given(st.integers(0, 10_000))
def test_it_is_the_first_crossing_of_all(seed):
    """Against a fine grid, for systems and signals of any kind."""
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((4, 4)) * 10.0 ** rng.uniform(-1, 1, (4, 4))
    rows, z = rng.standard_normal((3, 4)), rng.standard_normal(4)
    one = Flow(A, rows, np.full(3, 1e-12), 1.0)
    sides = np.where(rows @ z > 0, 1.0, -1.0)
    found = one.first_crossing(z, one.h, sides)
    times = np.linspace(0, one.h, 150)
    values = np.array([rows @ expm(A * time) @ z for time in times]) * sides
    across = np.flatnonzero((values < -1e-9).any(axis=1))
    if found is None:
        assert not len(across)
        return
    assert not len(across) or found <= times[across[0]]
    assert (rows @ one.advance(z, found) * sides).min() == pytest.approx(0, abs=1e-9)


def test_nothing_is_watched():
    one = Flow(OSCILLATOR, np.zeros((0, 3)), np.zeros(0), 0.5)
    z = np.array([0.0, 1.0, 1.0])
    assert one.first_doubtful(one.chunk(z, 3), np.zeros(0)) == 3
    assert one.first_crossing(z, one.h, np.zeros(0)) is None


@settings(max_examples=100)
@given(st.integers(0, 10_000), st.integers(1, CHUNK))
def test_signals_that_stay_do_not_cross(seed, count):
    rng = np.random.default_rng(seed)
    A = rng.standard_normal((4, 4)) * 10.0 ** rng.uniform(-1, 1, (4, 4)) - 2 * np.eye(4)
    rows, z = rng.standard_normal((3, 4)), rng.standard_normal(4)
    A[-1] = 0.0
    z[-1] = 1.0
    rows[:, -1] += rng.uniform(1, 20) * np.sign(rows[:, -1])
    one = Flow(A, rows, np.full(3, 1e-12), 1.0)
    sides = np.where(rows @ z > 0, 1.0, -1.0)
    states = one.chunk(z, count)
    stays = one.first_doubtful(states, sides) == count
    fine = [
        one.advance(state, share * one.h) for state in states[:-1] for share in (0.0, 0.3, 0.6, 1.0)
    ]
    crosses = bool((np.array(fine) @ rows.T * sides < -1e-9).any())
    assert not (stays and crosses)
    event(f"stays: {stays}, crosses: {crosses}")
