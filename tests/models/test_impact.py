"""Two masses and a spring: integrated step by step, and the criterion by all windows."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from nrs_design.models.impact import GRAVITY, HALF_SINE, Impact, above_root, below_root

F = Fraction
HAND = Impact(F(3), F("0.6"), F(75_000))


def simulated(impact, speed):
    """Return times, forces and what the spring held at most, by an integration."""
    robot, body, k = (float(v) for v in (impact.robot, impact.body, impact.stiffness))

    def rates(_, x):
        force = k * max(x[0] - x[1], 0.0)
        return [x[2], x[3], -force / robot, force / body]

    end = 4 * np.sqrt(float(impact.reduced_mass) / k)
    times = np.linspace(0, end, 4001)
    found = solve_ivp(
        rates, (0, end), [0, 0, speed, 0], t_eval=times, rtol=1e-9, atol=1e-12, max_step=end / 500
    )
    force = k * np.maximum(found.y[0] - found.y[1], 0)
    return times, force


@pytest.mark.parametrize("impact", [HAND, Impact(F(12), F("4.4"), F(150_000))])
def test_force_and_energy_are_those_of_the_motion(impact):
    _, force = simulated(impact, 0.25)
    assert force.max() == pytest.approx(float(impact.force(F(1, 4))), rel=1e-5)
    held = force.max() ** 2 / (2 * float(impact.stiffness))
    assert held == pytest.approx(float(impact.energy(F(1, 4))), rel=1e-5)


def test_the_criterion_is_the_largest_over_all_windows():
    times, force = simulated(HAND, 2.0)
    a = force / float(HAND.body * GRAVITY)
    gained = np.concatenate([[0.0], np.cumsum((a[1:] + a[:-1]) / 2 * np.diff(times))])
    few = slice(None, None, 8)
    t, v = times[few], gained[few]
    length = t[None, :] - t[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.where(length > 0, (v[None, :] - v[:, None]) ** 2.5 / length**1.5, 0.0)
    assert float(HAND.hic(F(2))) == pytest.approx(found.max(), rel=2e-4)
    assert float(HAND.hic(F(2))) >= found.max() * (1 - 1e-6)


def test_the_height_of_the_criterion_of_a_half_sine():
    u = np.linspace(0.5, np.pi / 2, 100_001)
    found = 2 * u * (np.sin(u) / u) ** 2.5
    assert found.max() <= float(HALF_SINE) <= found.max() * (1 + 1e-5)
    # Thesis 2.15 takes all of the contact.
    assert found[-1] / found.max() == pytest.approx(0.78, abs=5e-3)


@given(st.fractions(F(1, 100), 10), st.fractions(F(1, 10), 50), st.fractions(F(1, 10), 50))
def test_the_safe_speed_does_what_is_allowed_and_hardly_less(speed, robot, body):
    impact = Impact(robot, body, F(10_000))
    for does, allows in (
        (impact.energy, impact.speed_of_energy),
        (impact.force, impact.speed_of_force),
        (impact.hic, impact.speed_of_hic),
    ):
        safe = allows(does(speed))
        assert does(safe) <= does(speed) * (1 + F(1, 2**50))
        assert speed * (1 - F(1, 2**40)) <= safe <= speed * (1 + F(1, 2**50))


@given(st.fractions(F(1, 10**9), 10**9), st.sampled_from([2, 5]))
def test_roots_are_enclosed(x, degree):
    below, above = below_root(x, degree), above_root(x, degree)
    assert below**degree <= x <= above**degree
    assert above - below <= below / 2**50


def test_a_root_that_is_found_is_returned():
    assert above_root(F(9, 4), 2) == below_root(F(9, 4), 2) == F(3, 2)
