"""Rupture, and what looks like one."""

import numpy as np
import pytest

from nrs_design.identification.datasets.records import TissueRecord
from nrs_design.identification.tissue.rupture import find_rupture
from nrs_design.identification.tissue.trial import prepare
from nrs_design.models.contact import Elastic, HuntCrossley, KelvinVoigt, Maxwell, Motion
from tests.identification import synthetic
from tests.identification.coverage import TISSUES, colored
from tests.identification.support import quick, record, slow, source

ROWS = 3000


def torn(seed, side=1):
    """A ramp until the tissue tears; returns motion, force and the row."""
    generator = np.random.default_rng(seed)
    time = np.arange(ROWS) / 100
    at = int(generator.integers(1200, 2400))
    force = 400 * 0.0005 * time
    force[at:] *= generator.uniform(0.3, 0.7)
    force += 0.02 * generator.standard_normal(ROWS)
    return Motion(time, side * 0.0005 * time), side * force, at


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("seed", range(10))
def test_where_the_force_falls_while_the_probe_goes_on(seed, side):
    motion, force, at = torn(seed, side)
    assert find_rupture(motion, force)[0] == pytest.approx(at, abs=30)


@pytest.mark.parametrize(
    ("law", "motion", "noise"),
    [
        (Elastic(750.0), quick, 0.1),
        (KelvinVoigt(400.0, 8.0), quick, 0.05),
        (synthetic.NOSE, slow, 0.0216),
        (Maxwell(1.129, 20.0), slow, 0.0135),
        (HuntCrossley(0.28, 15.328, 1.2), slow, 0.0096),
    ],
)
def test_relaxation_and_unloading_are_none(law, motion, noise):
    for seed in range(10):
        data = record(law, motion(seed), noise, seed)
        assert find_rupture(data.motion, data.force) is None


def test_a_tissue_that_pulls_most_where_the_probe_is_back_is_not_torn():
    """A Maxwell tissue at the end of its presses, under a noise that hides which way it went."""
    data = colored(TISSUES["maxwell"], 235_560)
    size = np.abs(data.force - np.median(data.force[:32]))
    top = int(np.argmax(size))
    assert abs(data.motion.deflection[top] - data.motion.deflection[0]) < 0.01
    assert find_rupture(data.motion, data.force) is None


@pytest.mark.parametrize("side", [1, -1])
def test_a_tissue_that_is_torn_at_once_and_feels_nothing_from_then_on(side):
    motion, force, _ = torn(0, side)
    force[600:] = 0.02 * np.random.default_rng(1).standard_normal(ROWS - 600)
    assert find_rupture(motion, force)[0] == pytest.approx(600, abs=30)


def test_what_follows_is_cut_and_said():
    motion, force, at = torn(3)
    trial = prepare(TissueRecord(source("torn"), motion, force, False))
    (cut,) = trial.cuts
    assert "rupture at" in cut
    assert len(trial.force) == pytest.approx(at, abs=30)
    assert cut.startswith(f"{ROWS - len(trial.force)} samples")
