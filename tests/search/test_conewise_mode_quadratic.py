"""Search for functions of each mode for contact and free motion, in the sampled loop."""

import numpy as np
import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.reporting.evidence.norms import largest_norm
from nrs_design.reporting.evidence.offers import offer_of
from nrs_design.search import conewise_mode_quadratic
from nrs_design.search.certify import Limits, certify
from nrs_design.search.conewise_mode_quadratic import ConewiseModeProgram, search_conewise_modes
from nrs_design.search.conewise_quadratic import search_conewise
from nrs_design.search.family import Family
from nrs_design.search.ladder import applicable_methods
from nrs_design.search.method import Method
from nrs_design.work import Allowance, NotAffordableError
from tests.proof.graphs import shape_of
from tests.proof.systems import bouncing, bouncing_in_steps
from tests.search.support import found, outcome, thesis_robot

BOTH = ("2.15", "1.04")
slow = pytest.mark.slow


@pytest.mark.parametrize(
    ("k", "Mt", "delay"),
    [
        ("42.5", "0.01", 2),
        ("53.1", "0", 2),
        pytest.param("36.1", "0.01", 5, marks=slow),
        pytest.param("44.3", "0", 5, marks=slow),
    ],
)
def test_a_stiffness_that_moves_far_is_proved_while_contact_is_lost(k, Mt, delay):
    """Where no single function is found: the largest k that was proved in kept contact."""
    sampling = f"{{period: 2 ms, delay: {delay}}}"
    system = thesis_robot(("20", k), BOTH, Mt, sampling=sampling, contact="losable")
    assert found(search_conewise, system, optimize_rate=False) is None
    result = certify(system, limits=Limits(optimize_rate=False))
    assert result.verdict is Verdict.PROVED
    assert shape_of(result.evidence) == "conewise-mode-quadratic"
    forms = [form for place, form in result.evidence.nodes if place == "modes"]
    # Both ends of an enclosed number share theirs.
    assert (len(forms), len(set(forms))) == (8, 4)


def test_the_rate_is_raised():
    system = bouncing_in_steps()
    rates = [
        found(search_conewise_modes, system, optimize_rate=wanted).rate for wanted in (True, False)
    ]
    assert rates[0] < rates[1]


def test_where_it_applies():
    for system in (bouncing(), bouncing(1)):
        assert Method.CONEWISE_MODE_QUADRATIC not in applicable_methods(system)
    assert Method.CONEWISE_MODE_QUADRATIC in applicable_methods(bouncing_in_steps())


def test_five_samples_of_delay_are_not_found():
    """One mode is unstable by itself."""
    system = thesis_robot(("41.5", "44.2"), BOTH, "0.01", sampling="{period: 2 ms, delay: 5}")
    evidence, why = outcome(search_conewise_modes, system, optimize_rate=False)
    assert evidence is None
    assert why


@pytest.mark.parametrize("spoil", [lambda Q: -Q, lambda Q: Q * np.nan, lambda Q: np.eye(len(Q))])
def test_solutions_that_lie_give_no_false_evidence(monkeypatch, spoil):
    system = bouncing_in_steps()
    solution = ConewiseModeProgram(Family.of(system)).solve(1.0, Allowance())
    lie = type(solution)([spoil(Q) for Q in solution.touching], solution.flying, np.ones(1))
    monkeypatch.setattr(ConewiseModeProgram, "solve", lambda *_: lie)
    try:
        evidence = found(search_conewise_modes, system, optimize_rate=False)
    except (np.linalg.LinAlgError, ValueError, OverflowError):
        return
    assert evidence is None or evidence.find_fault(system) is None


def test_a_program_that_does_not_fit_is_not_built(monkeypatch):
    program = ConewiseModeProgram(Family.of(bouncing_in_steps()))
    monkeypatch.setattr(conewise_mode_quadratic, "symmetric_basis", lambda n: pytest.fail("built"))
    with pytest.raises(NotAffordableError, match=r"blocks.*--budget"):
        program.solve(1.0, Allowance(1e-4))


@pytest.mark.slow
def test_runs_through_contact_and_flight_never_leave_the_bound():
    """1,000 runs of 300 samples; the stiffness is anywhere in its range at every sample."""
    system = thesis_robot(("20", "42.5"), BOTH, "0.01", sampling="{period: 2 ms, delay: 2}")
    evidence = found(search_conewise_modes, system, optimize_rate=False)
    norm = largest_norm(offer_of(evidence).forms, system.order)
    maps = {mode.name: np.array(mode.A.floats()) for mode in system.modes}
    free = [np.array(mode.A.floats()) for mode in system.contact.free if "E-min" in mode.name]
    ends = [[maps[f"{c}/soft/k-{end}/E-min"] for end in ("min", "max")] for c in ("c0", "c1")]
    rng = np.random.default_rng(0)
    x = rng.standard_normal((1000, system.order)) / norm(np.eye(system.order))
    bounced = np.zeros(len(x), dtype=int)
    for _ in range(300):
        chosen, share = rng.integers(2, size=len(x)), rng.uniform(size=(len(x), 1, 1))
        low, high = (np.array([pair[k] for pair in ends])[chosen] for k in (0, 1))
        touching = x[:, -1:, None] > 0
        A = np.where(touching, (1 - share) * low + share * high, np.array(free)[chosen])
        after = (A @ x[:, :, None])[:, :, 0]
        assert (norm(after) < float(evidence.rate) * norm(x)).all()
        bounced += (after[:, -1] > 0) != touching[:, 0, 0]
        # Moved along the ray, as a run goes on for ever.
        x = after / norm(after)[:, None]
    assert np.median(bounced) >= 1


def _floats(functions):
    return [np.array(Q, dtype=float) for _, Q in functions]
