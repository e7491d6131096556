"""The robot of the thesis, chapter 6: motion loop of 6.3.2.2, designs of 6.3.1, 6.3.2 and 6.4.

The thesis switches between insertion and withdrawal (Bt 2.15 and 1.04) and between tissue and tool,
and cites 1002 +- 568 N/m at 0.24 m for a surgeon's hand.
"""

import pytest

from nrs_design.certificates.certify import certify

from .known import known, never_contradict, robot, settle


@pytest.mark.parametrize("coordinates", ["deflection", "force"])
@pytest.mark.parametrize("name", ["withdrawal-insertion", "tissue-tool"])
def test_the_switched_designs_of_the_thesis_are_proved(name, coordinates):
    settle(name, coordinates=coordinates)


def test_stiff_hand_with_virtual_mass_is_refuted_by_one_mode():
    assert settle("hand-with-mass").evidence.mode == "k=90.432 Bt=1.04"


@pytest.mark.parametrize("name", ["tissue-x-withdrawal", "hand-no-mass", "wide-no-mass"])
def test_nothing_wrong_where_no_quadratic_function_exists(name):
    never_contradict(name)


def test_zero_virtual_mass_needs_not_be_avoided():
    # Thesis 6.3.2.1 says that Mt must not be zero "due to the stability of switched systems".
    pair = robot("no-mass", "0", [["43.0356", "2.15"], ["43.0356", "1.04"]])
    found = certify(pair)
    assert found.verdict == "proved"
    assert found.evidence.rate > certify(known("withdrawal-insertion").system).evidence.rate
