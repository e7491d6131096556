"""Hunt and Crossley's law."""

import numpy as np
import pytest

from nrs_design.models.contact import HuntCrossley
from nrs_design.models.contact.motion import Motion

NOSE = HuntCrossley(rho=0.28, lam=15.328, phi=1.2)  # thesis table 2.4


def test_no_force_without_contact():
    motion = Motion(np.arange(4.0), np.array([-1.0, -0.5, 0.0, 1.0]))
    force = NOSE.simulate(motion)
    assert force[:3].tolist() == [0.0, 0.0, 0.0]
    assert force[3] > 0
    assert np.isfinite(NOSE.sensitivities(motion)).all()


def test_tangent_is_the_slope():
    k, b = NOSE.tangent(0.2)
    h = 1e-6

    def static(x):
        return NOSE.simulate(Motion(np.array([0.0, 1.0]), np.array([x, x])))[0]

    assert k == pytest.approx((static(0.2 + h) - static(0.2 - h)) / (2 * h), rel=1e-6)
    assert b == pytest.approx(15.328 * 0.2**1.2)


def test_slope_and_tangent_are_derivatives():
    law, step = NOSE, 1e-7
    time = np.linspace(0, 3, 60)
    there = Motion(time, 0.15 + 0.1 * np.sin(time))
    moved = Motion(there.time, there.deflection + step)
    assert law.slope(there) == pytest.approx(
        (law.simulate(moved) - law.simulate(there)) / step, rel=1e-4, abs=1e-5
    )
    for i in range(3):
        logs = np.log(law.values)
        logs[i] += 1e-6
        rise = np.log(HuntCrossley(*np.exp(logs)).tangent(0.1)) - np.log(law.tangent(0.1))
        assert law.tangent_sensitivities(0.1)[:, i] == pytest.approx(rise / 1e-6, rel=1e-4)
