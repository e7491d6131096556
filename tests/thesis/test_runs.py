"""Chapters 6 and 7, simulated."""

import math

import numpy as np
import pytest

from nrs_design.thesis import runs, thesis
from nrs_design.thesis.loops import ADMITTANCES
from nrs_design.thesis.table import topic_rows


@pytest.mark.parametrize(("Mt", "Bt"), ADMITTANCES)
@pytest.mark.parametrize("stiffness", [None, runs.HAND])
def test_the_total_torque_is_a_balance(Mt, Bt, stiffness):
    """``int F dt = Bt int vm dt + Mt vm``, and the robot is behind its admittance by 1/Kv."""
    run = runs.move(Mt, Bt, stiffness)
    # Thesis 6.12: (a1 - b1)/a0 of the realization.
    behind = run.last * (56.89 - 28.416) / 1618.8
    wanted = Bt * (runs.WAY + behind) + Mt * run.last
    if stiffness is None or Mt == 1 or Bt == 8:
        assert run.effort.total == pytest.approx(wanted, rel=2e-3)
    else:
        # This hand swings with the mass: it pulls, too, and both count.
        assert run.effort.total > wanted


def test_a_constant_torque_by_hand():
    """``v = F/Bt (1 - exp(-Bt t/Mt))`` but for the motion loop, which is some 20 ms behind."""
    t = np.linspace(0, 10, 100_001)
    v = thesis.TORQUE / 4 * (1 - np.exp(-4 * t))
    time = np.interp(runs.WAY, np.concatenate([[0], np.cumsum(v[1:] * 1e-4)]), t)
    assert runs.move(1, 4).time == pytest.approx(time + 0.0176, abs=2e-3)


def test_the_spec_of_the_runs_is_the_robot_of_the_thesis():
    """The peak under a proportional gain is that of the closed form of 6.41."""
    from nrs_design.design.force_loop import Approach, peak_force

    approach = Approach("reference", math.radians(5), 0.3)
    peak = peak_force(thesis.EXACT_LOOP, float(thesis.SOFT), 0.02, approach)
    row = next(row for row in topic_rows("runs") if "reference at the switch" in row.name)
    assert float(row.value.split(", ")[0]) == pytest.approx(peak, rel=1e-4)
