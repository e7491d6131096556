"""The gradient iteration on the three pairs of the thesis, in its own states."""

import numpy as np
import pytest

from nrs_design.search.family import Family
from nrs_design.search.gradient import Order
from nrs_design.thesis.switching import FEW_UPDATES, UPDATES, pairs, run

PAIRS = dict(pairs())
RADII = [10.0**power for power in range(13)]


def test_it_ends_on_position_and_force():
    """6.3.3.2, radius 1e5: how soon depends on rounding, and so does which order ends."""
    found = [run(PAIRS["6.3.3.2"], order=order) for order in Order]
    ended = [result for result in found if result.Q is not None]
    assert ended
    for result in ended:
        assert 100 < result.updates < UPDATES
        for A in Family.of(PAIRS["6.3.3.2"]).matrices:
            assert np.linalg.eigvalsh(A.T @ result.Q + result.Q @ A)[-1] < 0


@pytest.mark.parametrize("section", ["6.3.2.2", "6.4.1"])
def test_it_does_not_end_within_a_few_updates_on_the_others(section):
    found = run(PAIRS[section], updates=FEW_UPDATES)
    assert (found.Q, found.updates) == (None, FEW_UPDATES)


@pytest.mark.slow
@pytest.mark.parametrize("radius", RADII)
def test_over_the_radius(radius):
    """What the note of the rows and docs/certificates/gradient.md say of each radius."""
    ways = [(order, start) for order in Order for start in (0, 1)]
    ended = (run(PAIRS["6.3.3.2"], radius=radius, order=o, start=s).Q is not None for o, s in ways)
    assert any(ended)
    for section in ("6.3.2.2", "6.4.1"):
        found = run(PAIRS[section], radius=radius)
        assert (found.Q, found.updates) == (None, UPDATES)
