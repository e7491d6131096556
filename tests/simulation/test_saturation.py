"""Runs with signals that saturate, from the edge of the ellipsoid: none leaves it."""

import numpy as np
import pytest

from nrs_design.simulation.greedy import greedy_run
from nrs_design.simulation.norms import clipped, quadratic_norm
from tests.proof.systems import genuine, pushed_away
from tests.search.test_saturated_ellipsoid import found, thesis

KP, KD = 2060 * 56.9706, 2060.0


def norm_of(system, evidence):
    Q = np.ldexp(np.array(evidence.Q, dtype=float), -evidence.denominator_log2)
    norm = quadratic_norm(Q)
    return norm if system.contact is None else clipped(norm)


@pytest.mark.parametrize(
    ("dampings", "lost"),
    [
        pytest.param(("2.15", "1.04"), True, marks=pytest.mark.slow, id="both, lost"),
        pytest.param(("2.15",), True, id="insertion, lost"),
        pytest.param(("2.15",), False, marks=pytest.mark.slow, id="insertion"),
    ],
)
def test_no_run_from_the_edge_leaves(dampings, lost):
    """Greedy and random switching, both saturations, from all directions."""
    system = thesis(*dampings, lost=lost)
    evidence, _ = found(system)
    norm, rng = norm_of(system, evidence), np.random.default_rng(11)
    far = np.linalg.inv(np.array(evidence.Q, dtype=float))
    outward = [np.array([KP, -KD, share * KD, 0.0]) for share in (0.0, -0.02, -0.1, -1.0)]
    outward += [np.eye(4)[2], *(rng.normal(size=(4, 4)) / np.sqrt(np.diag(far)))]
    cut = np.zeros(2)
    for i, row in enumerate(outward * 2):
        x = far @ row
        x *= np.sign(x[-1])
        x /= norm(x[None])[0]
        choose = norm if i < len(outward) else lambda states: rng.random(len(states))
        run = greedy_run(system, choose, x, 5e-4, 500)
        values = norm(run.state)
        bound = np.exp(-float(evidence.rate) * run.time)
        assert (values <= bound * (1 + 1e-6)).all()
        assert values[-1] < 0.95
        e, omega, vm, _ = run.state.T
        v = np.clip(-vm, -0.13962634, 0.13962634)
        limited = np.array([np.abs(vm) > 0.13962634, np.abs(KP * e + KD * (v - omega)) > 2000])
        cut += limited.any(axis=1)
    # The region of both controllers ends before the driver is at its limit.
    assert cut[0] >= 2
    assert cut[1] >= 2 or len(dampings) == 2


def test_the_known_region_is_that_of_the_runs():
    system, _ = genuine("saturated-ellipsoid, scalar")
    assert system == pushed_away()
    norm = quadratic_norm(np.eye(1))
    for start, grows in ((0.99, False), (1.01, True)):
        run = greedy_run(system, norm, np.array([start]), 0.01, 1500)
        assert (abs(run.state[-1, 0]) > start) == grows
