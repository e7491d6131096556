"""Runs under a constant force: the robot of the thesis, its stiffness unknown but constant."""

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.search.certify import first_accepted
from nrs_design.search.constant_force import search_constant_force
from nrs_design.simulation.constant_force import pushed_in, pushed_norm
from nrs_design.switched.constant_force import with_constant_force
from nrs_design.work import Allowance
from tests.proof.systems import settling
from tests.search.support import thesis_robot
from tests.support import thinned


def test_the_loop_has_one_state_more():
    driven = pushed_in(settling())
    assert driven.states == ("x1", "d", "x2")
    assert driven.modes[1].A.floats() == [[-2, 2, -2], [0, 0, 0], [1, 0, 0]]
    assert driven.contact.free[1].A.floats() == [[-2, 2, 0], [0, 0, 0], [1, 0, 0]]
    assert driven.contact.free[1].name == "m1, free"


def test_the_norm_is_continuous_and_of_two_pieces():
    norm = pushed_norm(np.array([[5.0, 5], [5, 14]]), 11.0)
    states = np.array([[3.0, 2, 6], [3, 2, 0], [3, 2, -1]])
    # In contact e = 4; at the surface e = -2; in the air 2 s d times the distance more.
    expected = [45 + 2 * 60 + 14 * 16, 45 - 60 + 56, 45 - 60 + 56 + 44]
    assert norm(states) == pytest.approx(np.sqrt(expected))


@pytest.mark.parametrize("seed", thinned(range(6), 2))
def test_the_force_settles_and_v_never_rises(seed):
    """From the motion without force, and F - Fd in the place of F: as the robot would do it."""
    random, (low, high) = np.random.default_rng(seed), (41.5, 44.2)
    system = with_constant_force(thesis_robot(("41.5", "44.2"), ("2.15", "1.04"), "0.01"))
    evidence, _ = first_accepted(search_constant_force(system, Allowance()), system)
    scale = 2.0**-evidence.denominator_log2
    norm = pushed_norm(np.array(evidence.Q, dtype=float) * scale, evidence.slope * scale)
    k, Fd, step = random.uniform(low, high), 10 ** random.uniform(-2, 1), 1e-4
    push = np.zeros((5, 1))
    push[2] = 1 / 0.01  # The rate of vm, state 3, by a force.
    flows = {}
    for i, mode in enumerate(system.contact.free):
        A = np.zeros((5, 5))
        A[:4, :4] = np.array(mode.A.floats())
        for touching in (False, True):
            B = A.copy()
            B[:4, 4:] -= Fd * push[:4]
            B[:4, 3:4] += k * touching * push[:4]
            flows[i, touching] = expm(B * step)
    d = Fd / k
    x = np.array([*(random.normal(size=3) * [1e-3, 3e-2, 1.0]), d * random.uniform(-20, 5), 1.0])
    states, touched, mode = [x], set(), 0
    for t in range(60_000):
        if t % 400 == 0:
            mode = int(random.integers(2))
        x = flows[mode, bool(x[3] > 0)] @ x
        touched.add(bool(x[3] > 0))
        states.append(x)
    run = np.array(states)
    values = norm(np.column_stack([run[:, :3], np.full(len(run), d), run[:, 3]])) ** 2
    assert True in touched
    assert (np.diff(values) <= 1e-9 * values[:-1] + 1e-13 * values[0]).all()
    assert k * max(x[3], 0.0) == pytest.approx(Fd, rel=1e-3)
