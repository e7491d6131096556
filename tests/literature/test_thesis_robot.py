"""The robot of the thesis, chapter 6: motion loop of 6.3.2.2, designs of 6.3.1, 6.3.2 and 6.4.

The thesis switches between insertion and withdrawal (Bt 2.15 and 1.04) and between tissue and tool,
and cites 1002 +- 568 N/m at 0.24 m for a surgeon's hand.
"""

import pytest

from nrs_design.proof.evidence import GrowingSequence
from nrs_design.search.certify import certify
from nrs_design.spec import parse_exact
from tests.proof.graphs import shape_of

from .known import known, robot, settle


def test_stiff_hand_with_virtual_mass_is_refuted_by_one_mode():
    assert settle("hand-with-mass").evidence.steps[0][0] == "k=90.432 Bt=1.04"


@pytest.mark.parametrize("name", ["tissue-x-withdrawal", "hand-no-mass"])
def test_stable_without_a_quadratic_function(name):
    evidence = settle(name).evidence
    assert shape_of(evidence) == "common-polynomial"
    assert 2 * evidence.degree == known(name).degree


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [pytest.param("tissue-x-withdrawal", marks=pytest.mark.slow), "hand-no-mass"]
)
def test_stable_in_force_coordinates_too(name):
    assert shape_of(settle(name, coordinates="force").evidence) == "common-polynomial"


@pytest.mark.parametrize("coordinates", ["deflection", "force"])
def test_wide_range_without_virtual_mass_grows(coordinates):
    evidence = settle("wide-no-mass", coordinates=coordinates).evidence
    assert evidence.kind == "growing-sequence"
    assert {name for name, _ in evidence.steps} == {"k=1 Bt=2.15", "k=200 Bt=2.15"}


def test_published_period_grows():
    """0.04597 s in one mode and 0.03276 s in the other, in turn."""
    system = known("wide-no-mass").system
    soft, stiff = (mode.name for mode in system.modes)
    orders = [
        GrowingSequence(tuple((a, parse_exact(t)) for a, t in signal), 20).find_fault(system)
        for signal in (
            [(soft, "0.04597"), (stiff, "0.03276")],
            [(soft, "0.03276"), (stiff, "0.04597")],
        )
    ]
    assert None in orders


def test_zero_virtual_mass_needs_not_be_avoided():
    # Thesis 6.3.2.1 says that Mt must not be zero "due to the stability of switched systems".
    pair = robot("no-mass", "0", [["43.0356", "2.15"], ["43.0356", "1.04"]])
    found = certify(pair)
    assert found.verdict == "proved"
    assert found.evidence.rate > certify(known("withdrawal-insertion").system).evidence.rate
