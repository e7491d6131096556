"""A 95 % interval holds the truth in 90 to 99 % of 200 synthetic experiments.

Of 200, 95 % are 190 with a standard deviation of 3: 92 to 98 % is what chance alone leaves.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from nrs_design.identification.actuator import identify_actuator
from nrs_design.identification.tissue import fit_model, fit_record
from nrs_design.models.contact import Elastic, HuntCrossley, KelvinVoigt, Maxwell, Motion
from tests.identification import synthetic
from tests.identification.support import MOTOR, quick, record, sinusoids, slow
from tests.identification.unilateral import robot_record

SEEDS = 200


def off_grid(seed):
    """Presses whose rests are anywhere between two counts of the encoder."""
    motion = quick(seed)
    shift = synthetic.COUNT * np.random.default_rng([seed, 2]).uniform()
    return Motion(motion.time, motion.deflection + shift)


SINGLE = [
    (Elastic(768.17), off_grid, 0.0969, synthetic.COUNT),
    pytest.param(KelvinVoigt(0.574, 0.957), slow, 0.0114, 0.0, marks=pytest.mark.slow),
    pytest.param(Maxwell(1.129, 20.0), slow, 0.0135, 0.0, marks=pytest.mark.slow),
    pytest.param(synthetic.NOSE, slow, 0.0165, 1e-4, marks=pytest.mark.slow),
    pytest.param(synthetic.CONCHA, slow, 0.0085, 1e-4, marks=pytest.mark.slow),
    pytest.param(HuntCrossley(0.28, 15.328, 1.2), slow, 0.0096, 0.0, marks=pytest.mark.slow),
]

ROBOT = [
    (Elastic(768.17), quick, 0.0969),
    (KelvinVoigt(0.574, 0.957), slow, 0.0114),
    (Maxwell(1.129, 20.0), slow, 0.0135),
    (synthetic.NOSE, slow, 0.0165),
    (synthetic.CONCHA, slow, 0.0085),
    (HuntCrossley(0.28, 15.328, 1.2), slow, 0.0096),
]


def holds(estimates, values):
    return [e.covers(v) for e, v in zip(estimates, values, strict=True)]


@pytest.mark.parametrize(("law", "motion", "noise", "q"), SINGLE)
def test_one_record(law, motion, noise, q):
    hits = [
        holds(fit_record(type(law), record(law, motion(s), noise, s, q)).estimates, law.values)
        for s in range(SEEDS)
    ]
    rates = np.mean(hits, axis=0)
    assert (rates >= 0.90).all(), rates
    assert (rates <= 0.99).all(), rates


def rates_of(fits, law):
    return np.mean([holds(fit.estimates, law.values) for fit in fits], axis=0)


@pytest.mark.slow
@pytest.mark.parametrize(("law", "motion", "noise"), ROBOT)
def test_in_the_coordinates_of_a_robot(law, motion, noise):
    """A tare, a position of contact, and no air: only their sum is a parameter."""

    def shifted(seed):
        data = record(law, motion(seed), noise, seed)
        moved = Motion(data.motion.time, data.motion.deflection + 0.3)
        return replace(data, motion=moved, force=data.force - 0.2 * np.ptp(data.force))

    rates = rates_of((fit_record(type(law), shifted(seed)) for seed in range(SEEDS)), law)
    assert (rates >= 0.90).all(), rates
    assert (rates <= 0.99).all(), rates


@pytest.mark.slow
@pytest.mark.parametrize(("law", "motion", "noise"), ROBOT)
def test_colored_noise(law, motion, noise):
    """Noise with a memory of ten samples: the jackknife sees it."""

    def colored(seed):
        data = record(law, motion(seed), 0.0, seed)
        generator = np.random.default_rng(seed)
        error = lfilter([np.sqrt(1 - 0.81)], [1, -0.9], generator.standard_normal(len(data.force)))
        return replace(data, force=data.force + noise * error)

    rates = rates_of((fit_record(type(law), colored(seed)) for seed in range(SEEDS)), law)
    assert (rates >= 0.90).all(), rates
    assert (rates <= 0.995).all(), rates


@pytest.mark.slow
@pytest.mark.parametrize("drift", [0.0, 0.001])
@pytest.mark.parametrize(("law", "motion", "noise"), ROBOT)
def test_touches_in_air(law, motion, noise, drift):
    """Contact is found, lost and met again, by a tissue that pushes only."""
    fits = (
        fit_record(
            type(law),
            robot_record(law, motion(s), noise, s, zero=0.3, tare=-0.04, drift=drift),
        )
        for s in range(SEEDS)
    )
    rates = rates_of(fits, law)
    # An exponent ends at the bounds of the thesis, which takes from its own interval.
    least = 0.87 if isinstance(law, HuntCrossley) else 0.90
    assert (rates >= least).all(), rates
    assert (rates <= 0.995).all(), rates


@pytest.mark.slow
@pytest.mark.parametrize("spread", [0.0, 0.03])
def test_pooled_over_three_records(spread):
    """With spread: specimens differ by 3 %, as in thesis 6.1; the interval is for their mean."""
    hits = []
    for seed in range(SEEDS):
        factors = np.exp(spread * np.random.default_rng(10**6 + seed).normal(size=3))
        data = [
            record(Elastic(750.0 * f), quick(3 * seed + i), 0.12, 3 * seed + i, synthetic.COUNT)
            for i, f in enumerate(factors)
        ]
        hits += holds(fit_model(Elastic, data).estimates, [750.0])
    assert 0.90 <= np.mean(hits) <= 0.99, np.mean(hits)


@pytest.mark.slow
def test_actuator():
    truth = (synthetic.GAIN, synthetic.TIME_CONSTANT, synthetic.FRICTION)
    hits = []
    for seed in range(SEEDS):
        fit = identify_actuator(sinusoids(seed, (1.2, 2, 3, 4.5, 6, 9, 14)), MOTOR).chosen
        hits.append(holds((fit.gain, fit.time_constant, fit.friction), truth))
    rates = np.mean(hits, axis=0)
    assert (rates >= 0.90).all(), rates
    assert (rates <= 0.99).all(), rates
