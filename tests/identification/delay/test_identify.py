"""The delay of a running loop."""

from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np
import pytest

from nrs_design.identification.delay.identify import identify_delay, is_smooth
from nrs_design.identification.errors import DataError
from tests.identification import motors, signals

SEEDS = 200
LATE = motors.DELAY * signals.RATE


@pytest.mark.slow
def test_a_copy():
    found = identify_delay(signals.copy(1))
    assert found.fit.follower.name == "a copy"
    assert found.samples.covers(signals.DELAY)
    assert found.samples.high - found.samples.low < 0.5
    assert found.delay.value == pytest.approx(found.samples.value / signals.RATE)
    assert found.fit.gain == pytest.approx(0.9, abs=0.01)
    low, high = found.whole_samples
    assert low <= 2 < 3 <= high
    assert found.doubts == ()


def test_a_whole_number_of_samples_without_noise():
    record = signals.copy(1)
    seen = np.concatenate([np.full(4, record.command[0]), record.command[:-4]])
    found = identify_delay(replace(record, output=seen))
    assert found.samples.value == pytest.approx(4.0, abs=1e-6)
    assert found.whole_samples == (4, 4)
    assert found.periods(Fraction(found.record.step)) == (4, 4)
    assert found.periods(Fraction(found.record.step) * 3) == (1, 2)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        pytest.param({}, "a first-order lag", marks=pytest.mark.slow),
        pytest.param({"second": 0.02}, "a second-order lag", marks=pytest.mark.slow),
        ({"kind": "multisine", "is_angle": True}, "a lag and an integrator"),
    ],
)
def test_dynamics_are_no_delay(options, name):
    found = identify_delay(signals.lag(1, **options))
    assert found.fit.follower.name == name
    assert found.samples.value == pytest.approx(LATE, abs=0.15)
    if "integrator" not in name:
        # Both columns are most alike much later than the dead time.
        assert found.peak[0] > 2 * motors.DELAY


@pytest.mark.slow
def test_of_models_that_are_nearly_as_good_the_simplest_is_chosen():
    """Here a second, fast lag lowers BIC by 3 and takes a third of a sample from the delay."""
    found = identify_delay(signals.lag(92))
    least = min(found.fits, key=lambda fit: fit.bic)
    assert least.follower.name == "a second-order lag"
    assert found.fit.follower.name == "a first-order lag"
    assert found.samples.covers(LATE)


@pytest.mark.slow
def test_a_square_wave_turned_into_an_angle():
    # Delay and lag lie in a narrow valley: cut one by one, the steps of the search left it.
    delay, tau, step = 5, 0.05, 1 / signals.RATE
    sent = np.where(np.arange(signals.COUNT) % 500 < 250, 1.0, -1.0)
    acts = np.concatenate([np.full(delay + 1, sent[0]), sent[: -delay - 1]])
    velocity = np.zeros(signals.COUNT)
    for i in range(1, signals.COUNT):
        velocity[i] = acts[i] + (velocity[i - 1] - acts[i]) * np.exp(-step / tau)
    angle = np.cumsum(acts * step) - tau * velocity
    noise = 3e-4 * np.random.default_rng(1).normal(size=signals.COUNT)
    found = identify_delay(signals.pair(sent, angle + noise))
    assert found.samples.covers(delay)
    assert found.samples.high - found.samples.low < 2


@pytest.mark.slow
def test_a_delay_that_varies_is_said():
    delay = np.where(np.arange(signals.COUNT) < 1000, 1.0, 4.0)
    found = identify_delay(signals.copy(2, delay=delay))
    assert any("varies" in doubt for doubt in found.doubts)
    low, high = found.whole_samples
    assert low <= 1
    assert high >= 4


@pytest.mark.slow
def test_of_one_frequency_every_delay_up_to_that_of_a_copy_is_held():
    """A delay of 3 samples and a lag of 2 make the phase of 5: the delay is not near 5."""
    record = signals.copy(1)
    rate, w, tau = 1 / record.step, 2 * np.pi * 1.3, 2 * record.step
    phase = w * (record.time - 3 / rate) - np.arctan(w * tau)
    noise = 1e-3 * np.random.default_rng(2).normal(size=len(phase))
    seen = np.sin(phase) / np.hypot(1, w * tau) + noise
    found = identify_delay(replace(record, command=np.sin(w * record.time), output=seen))
    low, high = found.whole_samples
    assert low == 0
    assert high >= 5


def test_opposite_signs_are_said():
    found = identify_delay(signals.copy(3, gain=-0.9))
    assert any("opposite" in doubt for doubt in found.doubts)


def test_a_delay_beyond_what_is_looked_for_has_no_interval():
    """0.5 s in a record of 4 s were "0.48 [0.459, 0.502] s", or "0 [0, 0.045] s", at 95 %."""
    record = signals.copy(1)
    count = len(record.time)
    held = np.repeat(np.random.default_rng(1).normal(size=20), -(-count // 20))[:count]
    late = count // 8
    seen = np.concatenate([np.zeros(late), held[:-late]])
    with pytest.raises(DataError, match="no delay, with or without a lag, explains") as caught:
        identify_delay(replace(record, command=held, output=seen))
    assert "a tenth of the record" in caught.value.remedy


def test_columns_without_relation():
    record = signals.copy(5)
    with pytest.raises(DataError, match="does not follow") as caught:
        identify_delay(replace(record, output=np.random.default_rng(0).normal(size=signals.COUNT)))
    assert "--command" in caught.value.remedy


@pytest.mark.parametrize(
    ("delay", "begins", "noise"),
    [
        (0.5, 0.25, 0.01),
        (2.0, 0.0, 0.0),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in ((0.0, 0.3, 0.1), (1.4, 0.5, 0.0), (2.999, 0.5, 0.1), (4.6, 0.0, 0.1))
        ),
    ],
)
@pytest.mark.parametrize("lasts", [1.0, pytest.param(3.7, marks=pytest.mark.slow)])
def test_a_held_command_tells_no_part_of_a_sample(delay, begins, noise, lasts):
    """It changes at the samples of the log or between them, which no log says."""
    found = identify_delay(signals.held(1, delay, lasts=lasts, begins=begins, noise=noise))
    assert not found.smooth
    assert found.samples.covers(delay)
    assert found.samples.high - found.samples.low >= 1
    low, high = found.whole_samples
    assert low <= delay <= high
    assert "no interval is below a sample" in found.remarks[0]
    assert all(part.covers(delay) for _, part in found.parts)


def test_what_is_smooth_between_samples():
    assert is_smooth(signals.copy(1))
    assert not is_smooth(signals.held(1, 0.0, lasts=30.0))
    noise = np.random.default_rng(0).normal(size=signals.COUNT)
    assert not is_smooth(replace(signals.copy(1), command=noise))


def test_what_a_pause_leaves_out_is_noted_in_a_spec():
    """Delays of the other parts of the record are not in the range."""
    found = identify_delay(replace(signals.held(1, 2.0), pauses="1 pause"))
    assert (found.remarks[0], found.caveats[0]) == ("1 pause", "1 pause")


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("record", "truth", "most"),
    [
        (signals.copy, signals.DELAY, 0.98),
        # Beside a lag, an interval has a sample more: nobody knows when a logged command began.
        (signals.lag, LATE, 1.0),
        (partial(signals.lag, kind="multisine", is_angle=True), LATE, 1.0),
    ],
)
def test_coverage(record, truth, most):
    hits = [identify_delay(record(seed)).samples.covers(truth) for seed in range(SEEDS)]
    assert 0.92 <= np.mean(hits) <= most, np.mean(hits)


def test_milliseconds_that_pass_for_seconds_are_no_success():
    record = signals.held(1, 2.0)
    found = identify_delay(replace(record, time=1e3 * record.time))
    step, delay, *_ = found.doubts
    assert "the steps of time are 2 s: is that their unit? did you mean 2 ms?" in step
    assert "the delay is 4 s: is that its unit? did you mean 4 ms?" in delay
