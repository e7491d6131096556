"""The law in single precision: what the exact model says, up to rounding, and within its bounds."""

from fractions import Fraction

import numpy as np
import pytest

from benchmarks.bounded_runs import CASES, hold_against_bound
from benchmarks.single_precision import Choices, simulate_single_precision
from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.step_law import StepFrame, build_law
from tests.loop.frames import frame_of

TAU, KM, PERIOD = Fraction("0.0351"), Fraction("4.8417e-4"), Fraction(1, 500)
MOTION = StepFrame(Fraction(117359), Fraction(1_030_000))
T = Fraction(np.float32(0.002).item())
LAW = Admittance.discrete(Fraction(5, 8), Fraction(3, 16), T)


@pytest.mark.parametrize("law", [LAW, Admittance.discrete(None, Fraction(3, 8), T)])
@pytest.mark.parametrize("delay", [0, 2])
def test_it_follows_the_exact_model_up_to_rounding(law, delay):
    """A step of the command, in contact: the same as the rows of a frame, step after step."""
    frame = frame_of(PERIOD, MOTION, (law,), delay, TAU)
    n, values = len(frame.states), {"Km": KM, "k": Fraction(43), "b": Fraction(0)}
    rows = np.array(frame.rows(law, delay, values), dtype=float)
    x, expected = np.zeros(n), [0.0]
    for _ in range(200):
        x = rows[:n, :n] @ x + rows[:n, n] * 0.14
        expected.append(43 * x[-1])
    ones = np.ones((1, 200))
    choices = Choices(
        np.zeros((1, 200), int),
        np.full((1, 200), delay),
        43 * ones,
        float(KM) * ones,
        float(TAU) * ones,
        0.14 * ones,
    )
    forces = simulate_single_precision(
        build_law(MOTION, {"one": law}), float(PERIOD), choices, np.zeros(1), losable=False
    )
    size = max(np.abs(expected))
    assert forces[0] == pytest.approx(np.array(expected), abs=2e-4 * size)
    # With an offset, angles are coarser, and the force is off by what that rounds.
    shifted = simulate_single_precision(
        build_law(MOTION, {"one": law}), float(PERIOD), choices, np.full(1, 0.3), losable=False
    )
    assert 0 < np.abs(shifted[0] - forces[0]).max() < 1e-2 * size


def test_a_lost_surface_does_not_pull():
    ones = np.ones((1, 300))
    choices = Choices(
        np.zeros((1, 300), int),
        np.zeros((1, 300), int),
        43 * ones,
        float(KM) * ones,
        float(TAU) * ones,
        -0.1 * ones,
    )
    for losable, least in ((True, 0.0), (False, -0.1)):
        forces = simulate_single_precision(
            build_law(MOTION, {"one": LAW}), float(PERIOD), choices, np.zeros(1), losable=losable
        )
        assert bool(forces.min() >= 0) is losable
        assert forces.min() <= least


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES[:2])
def test_no_run_is_beyond_a_bound(case):
    """Few of the runs of `benchmarks.bounded_runs`; the bound is near where contact is kept."""
    level, reached, rounded = hold_against_bound(*case[:3], 300)
    assert rounded
    assert case[3] * level < reached < level
