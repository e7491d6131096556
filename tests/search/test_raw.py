"""The search in the coordinates of the spec, by CVXPY: same answers as the search of our own."""

import subprocess
import sys

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.search.lmi import find_common_quadratic, margins
from nrs_design.search.raw import find_raw_quadratic
from nrs_design.work import Allowance, NotAffordableError


@pytest.mark.parametrize("time", list(Time))
@pytest.mark.parametrize("seed", range(6))
def test_finds_what_our_own_method_finds(seed, time):
    generator = np.random.default_rng(seed)
    n, m = generator.integers(2, 6), generator.integers(2, 6)
    shift = generator.uniform(0.5, 2.5) * np.sqrt(n)
    matrices = generator.standard_normal((m, n, n)) - shift * np.eye(n)
    rate = 0.0
    if time is Time.DISCRETE:
        matrices, rate = np.eye(n) + matrices / 8, 1.0
    found = find_raw_quadratic(matrices, time, rate, Allowance())
    assert (found is None) == (find_common_quadratic(matrices, time, rate) is None)
    if found is not None:
        assert margins(matrices, found, time, rate).min() > 0


def test_a_rate_is_kept():
    matrices = np.array([[[-1.0, 4.0], [0.0, -1.0]], [[-1.0, 0.0], [0.5, -1.0]]])
    for rate in (0.2, 0.9):
        found = find_raw_quadratic(matrices, Time.CONTINUOUS, rate, Allowance())
        exists = find_common_quadratic(matrices, Time.CONTINUOUS, rate) is not None
        assert (found is not None) == exists == (rate < 0.25)


def test_a_solver_that_gives_up_has_found_nothing(monkeypatch):
    import cvxpy

    def fail(*arguments, **options):
        raise cvxpy.SolverError("stalled")

    monkeypatch.setattr(cvxpy.Problem, "solve", fail)
    assert find_raw_quadratic(-np.eye(2)[None], Time.CONTINUOUS, 0.0, Allowance()) is None


@pytest.mark.parametrize(
    ("allowance", "words"),
    [(Allowance(1.0), "loading CVXPY would take"), (Allowance(memory=1e5), "a program of")],
)
def test_what_does_not_fit_is_not_begun(allowance, words):
    matrices = -np.broadcast_to(np.eye(12), (2, 12, 12))
    with pytest.raises(NotAffordableError, match=words):
        find_raw_quadratic(matrices, Time.CONTINUOUS, 0.0, allowance)


@pytest.mark.parametrize("size", [1e150, 1e154, 1e190, 1e307])
def test_modes_beyond_floating_point_have_no_candidate(size):
    matrices = size * np.array([[[0.5, 1.0], [0.3, 0.2]], [[0.5, -1.0], [0.3, 0.1]]])
    with np.errstate(all="ignore"):
        assert find_raw_quadratic(matrices, Time.DISCRETE, 1.0, Allowance()) is None


def test_the_library_is_loaded_by_a_search_only():
    program = "import sys, nrs_design.search.certify; print('cvxpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout == "False\n"
