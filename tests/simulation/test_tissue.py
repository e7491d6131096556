"""Tissue that remembers, against closed forms."""

import math

import numpy as np
import pytest

from nrs_design.models.contact.law import Element
from nrs_design.simulation.scenario import Surface
from nrs_design.simulation.tissue import Tissue
from tests.simulation.interactions import simulated, text_of

REST, FAST, SLOW = Element(30.0), Element(20.0, b=0.4), Element(10.0, b=2.0)
# The same as FAST beside REST, in the form of thesis 2.5: series 50, parallel 75 N m/rad.
ARMS = {
    "soft": "{model: elastic, stiffness: 30 N*m/rad}",
    "arm": "{model: maxwell, stiffness: 20 N*m/rad, damping: 0.4 N*m*s/rad}",
}
SOLID = (
    "{model: kelvin-boltzmann, parallel_stiffness: 75 N*m/rad, series_stiffness: 50 N*m/rad, "
    "damping: 2.5 N*m*s/rad}"
)
RUN = (
    "command: {sinusoid: {amplitude: 8 deg/s, frequency: 1.5 Hz}}, duration: 1.5 s, "
    "surfaces: [{environment: soft, at: 0.3 deg%s}], control: {fixed: insertion}"
)


def body(*arms):
    return Tissue((Surface("soft", None, REST, 0.0, 1, arms),))


def test_a_prony_series_relaxes_as_the_sum_of_its_exponentials():
    tissue, depth = body(FAST, SLOW), 0.01
    for k in range(200):
        t = 0.001 * k
        wanted = 30 + 20 * math.exp(-t * 20 / 0.4) + 10 * math.exp(-t * 10 / 2.0)
        assert tissue.torque(depth, 0.0) == pytest.approx(wanted * depth, rel=1e-12)
        tissue.creep([depth], [depth], 0.001)


def test_arms_pull_each_other_back_and_never_the_robot():
    """Let go, the body returns: its surface is where the arms are in balance."""
    tissue, depth = body(FAST), 0.01
    for _ in range(200):
        tissue.creep([depth], [depth], 0.001)
    kept = tissue.dampers[0][1]
    assert 0.009 < kept < depth
    at = 20 * kept / 50
    assert tissue.torque(at * 0.999, 0.0) == 0.0
    assert 0 < tissue.torque(at * 1.001, 0.0) < 1e-3
    # Free: d' = k (s - d)/b with s = 20 d/50.
    for _ in range(100):
        tissue.creep([0.0], [0.0], 1e-4)
    assert tissue.dampers[0][1] == pytest.approx(kept * math.exp(-0.01 * 20 * 0.6 / 0.4), rel=1e-3)


def test_one_arm_beside_a_spring_is_the_standard_linear_solid():
    """Two descriptions of one body: contact made, lost and made again."""
    series = text_of(scenario=RUN % ", beside: [arm]", environments=ARMS)
    solid = text_of(scenario=RUN % "", environments={"soft": SOLID})
    one, other = (
        simulated(text, "sampled", sampling=("0.5 ms", 0)).response for text in (series, solid)
    )
    assert one["torque"] == pytest.approx(other["torque"], abs=2e-4)
    assert one["torque"].max() > 0.1
    assert np.count_nonzero(np.diff((one["torque"] > 0).astype(int))) > 2
    alone = simulated(
        text_of(scenario=RUN % "", environments=ARMS), "sampled", sampling=("0.5 ms", 0)
    ).response
    assert np.abs(one["torque"] - alone["torque"]).max() > 0.01
