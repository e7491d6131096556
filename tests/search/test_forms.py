"""One program for forms on any graph."""

from dataclasses import replace
from functools import partial

import cvxpy as cp
import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.search import forms, graphs
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.search.forms import FormsProgram
from nrs_design.search.work import Allowance, NotAffordableError
from tests.proof import systems
from tests.search.support import found
from tests.support import thinned

QUARTIC = partial(graphs.search_polynomial, degree=2)
QUARTIC_WITH_FLIGHT = partial(graphs.search_conewise_polynomial, degree=2)
DRAWN = [
    (graphs.search_conewise_modes, systems.bouncing_in_steps(), graphs.draw_conewise_modes),
    (
        graphs.search_periodic_quadratic,
        systems.bouncing_in_turns(1, rounded=True),
        lambda f: next(graphs.draw_turns(f, f.system.clock)),
    ),
    (graphs.search_together, systems.bouncing(), lambda f: graphs.draw_together(f, 1, lost=True)),
    (graphs.search_modes, systems.geromel_colaneri(3), lambda f: next(graphs.draw_each_mode(f, 1))),
    (QUARTIC, systems.dayawansa_martin(6), lambda f: graphs.draw_together(f, 2)),
    (QUARTIC_WITH_FLIGHT, systems.bouncing(), lambda f: graphs.draw_together(f, 2, lost=True)),
]


def at_rest(system):
    return 0.0 if system.time is Time.CONTINUOUS else 1.0


@pytest.mark.parametrize(
    "spoil", [lambda Q: -Q, lambda Q: Q * np.nan, lambda Q: np.eye(len(Q)), lambda Q: 1e300 * Q]
)
@pytest.mark.parametrize(("search", "system", "draw"), DRAWN)
def test_solutions_that_lie_give_no_false_evidence(monkeypatch, search, system, draw, spoil):
    with floats_in_silence():
        solution = FormsProgram(draw(Family.of(system))).solve(at_rest(system), Allowance())
        lie = replace(
            solution,
            forms=[spoil(Q) for Q in solution.forms],
            vanishing=[spoil(N) for N in solution.vanishing],
        )
    monkeypatch.setattr(FormsProgram, "solve", lambda *_: lie)
    try:
        evidence = found(search, system, optimize_rate=False)
    except (np.linalg.LinAlgError, ValueError, OverflowError):
        return
    assert evidence is None or evidence.find_fault(system) is None


@pytest.mark.parametrize(("search", "system", "draw"), DRAWN)
def test_a_program_that_does_not_fit_is_not_begun(monkeypatch, search, system, draw):
    program = FormsProgram(draw(Family.of(system)))
    monkeypatch.setattr("clarabel.DefaultSolver", lambda *_: pytest.fail("begun"))
    with pytest.raises(NotAffordableError, match=r"blocks.*--budget"):
        program.solve(at_rest(system), Allowance(1e-4))


@pytest.mark.parametrize(("search", "system", "draw"), DRAWN[:2])
def test_a_solution_shows_the_rate_that_it_was_asked_for(search, system, draw):
    program = FormsProgram(draw(Family.of(system)))
    assert program.own_rate(program.solve(0.99, Allowance())) < 0.99


@pytest.mark.parametrize(("search", "system", "draw"), DRAWN[:2])
def test_edges_that_a_solution_violates_are_added(monkeypatch, search, system, draw):
    monkeypatch.setattr(forms, "FIRST_EDGES", 1)
    program = FormsProgram(draw(Family.of(system)))
    assert len(program.active) == 1
    assert program.solve(0.99, Allowance()) is not None
    whole = FormsProgram(draw(Family.of(system)))
    whole.active = list(range(len(whole.edges)))
    assert whole.solve(0.99, Allowance()) is not None
    assert whole.solve(0.5, Allowance()) is None
    assert program.solve(0.5, Allowance()) is None
    assert len(program.active) > 1


def test_forms_that_are_nearly_zero_are_no_solution():
    """The best rate is ``sqrt(3)/2``; below it, the solver finds none but zero, with a margin."""
    assert found(graphs.search_modes, systems.two_ways(3)).rate < 0.8665


def drawn(seed):
    generator = np.random.default_rng(seed)
    n, m = generator.integers(2, 7), generator.integers(2, 6)
    shift = generator.uniform(0.5, 2.5) * np.sqrt(n)
    return generator.standard_normal((m, n, n)) - shift * np.eye(n)


def solved(matrices, time=Time.CONTINUOUS):
    system = systems.family(*matrices.round(6).tolist(), time=time)
    program = FormsProgram(graphs.draw_balanced(Family.of(system)))
    rate = at_rest(system)
    solution = program.solve(rate, Allowance())
    # At zero, solvers may see a margin of the size of their errors.
    return solution is not None and program.margins(solution, rate).min() > 0


@pytest.mark.parametrize("seed", thinned(range(30), 12))
def test_existence_agrees_with_cvxpy(seed):
    """The usual form, written as a person would write it."""
    matrices = drawn(seed).round(6)
    n = matrices.shape[1]
    Q, t = cp.Variable((n, n), symmetric=True), cp.Variable()
    constraints = [Q >> 0, np.eye(n) - Q >> 0]
    constraints += [A.T @ Q + Q @ A + t * np.eye(n) << 0 for A in matrices]
    cp.Problem(cp.Maximize(t), constraints).solve(solver=cp.CLARABEL)
    if not 1e-8 <= float(t.value) <= 1e-4:
        assert solved(matrices) == (float(t.value) > 1e-4)


def test_both_answers_occur():
    """The comparison above says something only if its families are of both sorts."""
    assert {solved(drawn(seed)) for seed in range(30)} == {True, False}


@pytest.mark.parametrize("time", list(Time))
def test_few_modes_at_a_time_find_the_same(time):
    noise = np.random.default_rng(7).uniform(-0.2, 0.2, (60, 3, 3))
    matrices = noise - np.eye(3) if time is Time.CONTINUOUS else noise
    assert solved(matrices, time)
    matrices[41] = np.eye(3)
    assert not solved(matrices, time)
