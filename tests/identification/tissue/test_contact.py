"""Air, touches and loss of contact."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from nrs_design.identification.tissue.contact import find_contact, inner
from nrs_design.models.contact import Elastic, HuntCrossley, KelvinVoigt, Maxwell
from tests.identification import synthetic
from tests.identification.support import quick, record, slow
from tests.identification.unilateral import robot_record
from tests.support import thinned

STIFF = [Elastic(400.0), KelvinVoigt(400.0, 8.0), HuntCrossley(1500.0, 3000.0, 1.25)]
SOFT = [synthetic.NOSE, synthetic.CONCHA, Maxwell(1.129, 20.0)]
IN_TURNS = [law for pair in zip(STIFF, SOFT, strict=True) for law in pair]


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("law", [*STIFF, *SOFT], ids=lambda law: law.name)
def test_contact_is_found_on_either_side(law, side):
    motion, noise = (quick(1), 0.03) if law in STIFF else (slow(1), 0.01)
    found = find_contact(robot_record(law, motion, noise, 1, zero=0.1, tare=-0.1, side=side))
    assert found.side == side
    assert found.zero == pytest.approx(0.1, abs=0.1 * np.ptp(motion.deflection))
    # A Maxwell tissue does not come back, so that a shallow touch may miss it.
    assert len(found.touches) >= 3


@pytest.mark.parametrize("law", thinned(reversed(IN_TURNS), 3), ids=lambda law: law.name)
def test_without_air_nothing_is_found(law):
    motion, noise = (quick, 0.05) if law in STIFF else (slow, 0.015)
    assert not any(find_contact(record(law, motion(seed), noise, seed)) for seed in range(10))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "noise"), [(synthetic.NOSE, 0.0165), (Maxwell(1.129, 20.0), 0.0135)]
)
def test_noise_with_a_memory_is_no_air(law, noise):
    def colored(seed):
        data = record(law, slow(seed))
        error = np.random.default_rng(seed).standard_normal(len(data.force))
        return replace(data, force=data.force + noise * lfilter([0.436], [1, -0.9], error))

    assert sum(find_contact(colored(seed)) is not None for seed in range(40)) <= 1


@pytest.mark.parametrize("law", thinned(IN_TURNS, 3), ids=lambda law: law.name)
def test_the_edge_holds_the_position_of_contact(law):
    motion, noise = (quick, 0.03) if law in STIFF else (slow, 0.01)
    held = []
    for seed in range(20):
        found = find_contact(robot_record(law, motion(seed), noise, seed))
        # A curve that is not the law is off by a little more.
        off = 0.02 * 1.4 * np.ptp(motion(seed).deflection)
        held.append(found.ends[0] - off < -found.zero < found.ends[1] + off)
    assert sum(held) >= 18


@pytest.mark.parametrize("seed", [27, 124, 147, 183, 36, 79, 113])
def test_air_that_no_single_touch_shows(seed):
    """Four touches of a soft tissue in noise tell together what each leaves open.

    In the last three the second touch meets a tissue that has not come back, a fifth of the travel
    deeper.
    """
    motion = slow(seed)
    found = find_contact(robot_record(synthetic.NOSE, motion, 0.0165, seed, tare=-0.04))
    assert found is not None
    if seed in (36, 79, 113):
        assert abs(found.zero) < 0.1 * 1.4 * np.ptp(motion.deflection)


def test_samples_whose_noise_decides_where_a_touch_ends_are_left_out():
    touching = np.zeros(30, bool)
    touching[5:15] = touching[20:23] = True
    assert np.flatnonzero(inner(touching)).tolist() == [8, 9, 10, 11]


def test_a_tissue_that_relaxes_is_lost_early_and_met_late():
    found = find_contact(robot_record(synthetic.CONCHA, slow(2), 0.005, 2))
    for touch in found.touches:
        assert touch.first <= touch.force_begin < touch.force_end <= touch.end
    second = found.touches[1]
    assert second.force_begin > second.first
    assert second.force_end < second.end
