"""Search for functions under a constant force: known answers for the robot of the thesis.

The ranges were found by an independent program, and proved in exact arithmetic there.
"""

import numpy as np
import pytest

from nrs_design.proof.evidence import ConstantForce, Shows
from nrs_design.search.certify import certify, first_accepted
from nrs_design.search.constant_force import find_constant_force, search_constant_force
from nrs_design.switched.constant_force import with_constant_force
from nrs_design.work import Allowance, NotAffordableError
from tests.proof.systems import family, settling
from tests.search.support import thesis_robot

BOTH, INSERTION, WITHDRAWAL = ("2.15", "1.04"), ("2.15",), ("1.04",)


def search(system):
    return first_accepted(search_constant_force(system, Allowance()), system)


def robot(*arguments):
    return with_constant_force(thesis_robot(*arguments))


@pytest.mark.parametrize(
    ("k", "Bt", "Mt", "tolerance"),
    [
        (("41.5", "44.2"), BOTH, "0.01", "0"),
        (("41.5", "44.2"), BOTH, "0.01", "0.02"),
        (("41.5", "44.2"), BOTH, "0", "0"),
        # Tissue and tool: 43 to 62 takes two ranges, which overlap.
        (("43", "60.8"), BOTH, "0.01", "0"),
        (("48", "62.2"), BOTH, "0.01", "0"),
        # Withdrawal is stable up to 75.9 N m/rad, insertion up to 232.
        (("75.8", "75.8"), WITHDRAWAL, "0.01", "0"),
        (("200", "200"), INSERTION, "0.01", "0"),
    ],
)
def test_the_robot_settles(k, Bt, Mt, tolerance):
    system = robot(k, Bt, Mt, tolerance)
    evidence, words = search(system)
    assert isinstance(evidence, ConstantForce), words
    assert evidence.find_fault(system) is None


@pytest.mark.parametrize(
    ("k", "Bt"), [(("43", "62"), BOTH), (("70", "80"), WITHDRAWAL), (("70", "76.2"), BOTH)]
)
def test_what_is_not_shown(k, Bt):
    """The upper end of the last two is beyond what withdrawal by itself is stable for."""
    evidence, words = search(robot(k, Bt, "0.01"))
    assert evidence is None
    assert words


def test_it_is_a_statement_beside_the_one_that_decides():
    result = certify(settling())
    assert [item.shows for item in result.statements] == [Shows.STABILITY, Shows.CONVERGENCE]
    assert result.attempts[-1].step == "constant force"
    assert result.attempts[-1].outcome == "found"


@pytest.mark.slow
def test_a_statement_that_is_missing_is_listed_among_the_attempts():
    result = certify(robot(("43", "62"), BOTH, "0.01"))
    assert [item.shows for item in result.statements if item.shows is Shows.CONVERGENCE] == []
    assert result.verdict == "proved"
    last = result.attempts[-1]
    assert (last.step, last.outcome) == (
        "constant force",
        "the solver found no solution with positive margins",
    )


def test_a_search_that_does_not_fit_is_not_made():
    with pytest.raises(NotAffordableError):
        find_constant_force(np.eye(2)[None], Allowance(memory=1.0))


def test_numbers_beyond_floating_point_are_no_candidates():
    huge = family([[-(10**200), -(10**290)], [10**290, 0]])
    evidence, words = search(huge)
    assert evidence is None
    assert words
