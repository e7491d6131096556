"""Search for one function per mode."""

import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.search import forms
from nrs_design.search.family import Family
from nrs_design.search.graphs import search_modes
from nrs_design.search.polynomial import PER_CHECK, functions_cost
from nrs_design.work import Allowance, NotAffordableError
from tests.proof.systems import (
    ando_shih,
    family,
    geromel_colaneri,
    rectangular,
    shears,
    slow_switching_in_steps,
)
from tests.search.support import found


@pytest.mark.parametrize(
    "system",
    [geromel_colaneri("2.752"), ando_shih("0.99"), rectangular(), slow_switching_in_steps()],
)
def test_what_is_found_passes_the_exact_check(system):
    assert found(search_modes, system).find_fault(system) is None


@pytest.mark.parametrize("system", [geromel_colaneri("2.74"), shears(), ando_shih("1.001")])
def test_nothing_is_found_where_there_is_nothing(system):
    assert found(search_modes, system) is None


def test_no_ends_of_constant_parameters():
    system = shears(Switching(transitions=(), fixed_ends=(("m0", "m1"),)))
    assert found(search_modes, system) is None


def test_a_solver_that_is_content_with_every_rate_raises_none(monkeypatch):
    """It gives the functions for no decay at every rate: what is proved is what these show."""
    true, kept = forms.FormsProgram.solve_for, []

    def content(*arguments, **options):
        kept.append(kept[0] if kept else true(*arguments, **options))
        return kept[0]

    system = geromel_colaneri("2.76")
    honest = found(search_modes, system)
    monkeypatch.setattr(forms.FormsProgram, "solve_for", content)
    claimed = [c.evidence.rate for c in search_modes(Family.of(system))]
    assert max(claimed) > 100 * honest.rate
    evidence = found(search_modes, system)
    assert 0 < evidence.rate <= honest.rate


def test_fast_ones_are_proposed_first():
    rates = [c.evidence.rate for c in search_modes(Family.of(ando_shih("0.99")))]
    assert len(set(rates)) > 1
    assert rates == sorted(rates)


def test_exact_checks_are_part_of_the_work_that_is_predicted():
    """12 modes that may follow each other in any order: 156 forms, each checked twice."""
    modes = [[[f"{k}/100", "1/2"], [0, "1/3"]] for k in range(12)]
    system = family(*modes, time=Time.DISCRETE)
    solution, _ = functions_cost(system, 1)
    allowance = Allowance(solution.work + 0.01)
    with pytest.raises(NotAffordableError, match="with the exact check of what it finds"):
        next(search_modes(Family.of(system, allowance)))
    checks = 2 * 156 * 4 * PER_CHECK
    enough = Allowance(2 * solution.work + checks + 60.0)
    assert next(search_modes(Family.of(system, enough))).evidence
