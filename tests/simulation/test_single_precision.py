"""The law in single precision: what the exact model says, up to rounding, and within its bounds."""

from fractions import Fraction

import numpy as np
import pytest
from nrs_design.controllers.sampled import SampledAdmittance, SampledMotion
from nrs_design.simulation.single_precision import Choices, simulate_single_precision

from benchmarks.bounded_runs import CASES, hold_against_bound
from nrs_design.switched.sampled_frame import Frame

TAU, KM, PERIOD = Fraction("0.0351"), Fraction("4.8417e-4"), Fraction(1, 500)
MOTION = SampledMotion(Fraction(117359), Fraction(1_030_000))
LAW = SampledAdmittance(Fraction(5, 8), Fraction(3, 16), Fraction(np.float32(0.002).item()))


@pytest.mark.parametrize("inertia", [True, False])
@pytest.mark.parametrize("delay", [0, 2])
def test_it_follows_the_exact_model_up_to_rounding(inertia, delay):
    """A step of the command, in contact: the same as the rows of a frame, step after step."""
    law = LAW if inertia else SampledAdmittance(None, Fraction(3, 8), LAW.T)
    frame = Frame(PERIOD, MOTION, inertia, delay, TAU)
    n, E = len(frame.states), np.exp(-float(PERIOD / TAU))
    values = {"Km": KM, "E": Fraction(E), "k": Fraction(43), "b": Fraction(0)}
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
        MOTION, [law], float(PERIOD), choices, np.zeros(1), losable=False
    )
    size = max(np.abs(expected))
    assert forces[0] == pytest.approx(np.array(expected), abs=2e-4 * size)
    # With an offset, angles are coarser, and the force is off by what that rounds.
    shifted = simulate_single_precision(
        MOTION, [law], float(PERIOD), choices, np.full(1, 0.3), losable=False
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
            MOTION, [LAW], float(PERIOD), choices, np.zeros(1), losable=losable
        )
        assert bool(forces.min() >= 0) is losable
        assert forces.min() <= least


def test_a_spring_is_not_simulated_as_if_there_were_none():
    law = SampledAdmittance(LAW.a, LAW.b, LAW.T, Fraction(1, 2))
    one = np.ones((1, 1))
    choices = Choices(np.zeros((1, 1), int), np.zeros((1, 1), int), one, one, one, one)
    with pytest.raises(ValueError, match="spring Kt"):
        simulate_single_precision(MOTION, [law], 0.002, choices, np.zeros(1), losable=False)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES[:2])
def test_no_run_is_beyond_a_bound(case):
    """Few of the runs of `benchmarks.bounded_runs`; the bound is near where contact is kept."""
    level, reached, rounded = hold_against_bound(*case[:3], 300)
    assert rounded
    assert case[3] * level < reached < level
