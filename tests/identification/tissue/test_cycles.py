"""Loading cycles."""

import numpy as np

from nrs_design.identification.tissue.cycles import find_cycles


def test_each_cycle_begins_with_its_load():
    ramp = np.concatenate([np.linspace(0, 1, 50), np.linspace(1, 0, 50)])
    cycles = find_cycles(np.tile(ramp, 3))
    assert [(c.start, c.stop) for c in cycles] == [(0, 100), (100, 200), (200, 300)]


def test_small_turns_do_not_count():
    time = np.linspace(0, 2, 500)
    assert len(find_cycles(time + 0.05 * np.sin(40 * time))) == 1
    assert find_cycles(np.zeros(9)) == (slice(0, 9),)
