"""Tissue that remembers, against closed forms."""

import math

import pytest

from nrs_design.models.contact.law import Element
from nrs_design.simulation.scenario import Surface
from nrs_design.simulation.tissue import Tissue


def test_a_maxwell_element_relaxes_and_pulls_nothing():
    """``F = k exp(-k t/b) delta`` at a depth; where it would pull there is no force."""
    tissue, depth = Tissue((Surface("soft", Element(20.0, b=0.4), 0.0, 1),)), 0.01
    for k in range(200):
        wanted = 20 * math.exp(-0.001 * k * 20 / 0.4)
        assert tissue.torque(depth, 0.0) == pytest.approx(wanted * depth, rel=1e-12)
        tissue.creep([depth], [depth], 0.001)
    assert tissue.torque(0.5 * depth, 0.0) == 0.0
    kept = tissue.dampers[0]
    tissue.creep([0.0], [0.0], 0.001)
    assert tissue.dampers[0] == kept > 0.5 * depth
