"""Modes of a loop in intervals of time, against the textbook's map from sample to sample."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.certificate import Verdict
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from tests.loop.timed_loop import floats, parts, sampled, timed

PLANT = ([[0, 1], [-2, "-0.3"]], [[0, 1], [1, "0.5"]])
GAIN = [[-1, "-0.5"], ["0.25", -1]]


def along(system, times):
    """Return the characteristic polynomial along stays of these lengths, each with its reset."""
    modes = {mode.name: np.array(mode.A.floats()) for mode in system.modes}
    maps = {reset.source: np.array(reset.map.floats()) for reset in system.switching.resets}
    product = np.eye(system.order)
    for name, time in times:
        product = maps[name] @ expm(modes[name] * time) @ product
    return np.poly(product)


@pytest.mark.parametrize("late", [False, True])
def test_the_map_from_sample_to_sample(late):
    A, B, K = map(floats, (*PLANT, GAIN))
    system = timed(PLANT, GAIN, ("0.5", 2), (0, "0.4") if late else None)
    rng = np.random.default_rng(0)
    expected, times = np.eye(4), []
    for k in range(4):
        h, d = rng.uniform(0.5, 2), rng.uniform(0, 0.4) * late
        expected = sampled(A, B, h, d, K) @ expected
        times += [("delay", d), ("period", h)] if late else [(f"period/{k % 2 + 1}", h)]
    # States for the delay add zeros.
    found = along(system, times)
    np.testing.assert_allclose(found[:5], np.poly(expected), rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(found[5:], 0, atol=1e-9)


@pytest.mark.parametrize("whole", [1, 2, 3])
def test_commands_that_wait(whole):
    """Registers around the same gain."""
    A, B, K = map(floats, (*PLANT, GAIN))
    h, expected = 0.5, np.eye(2 + 2 * (whole + 1))
    for d in (0.125, 0.25):
        # The last command is the one before, and that behind it the new one.
        after = np.eye(len(expected), k=-2)
        after[2:4, :2] = K
        after[:2, :2], after[:2, -2:], after[:2, -4:-2] = parts(A, B, h, d)
        expected = after @ expected
    delay = tuple(str(whole * h + rest) for rest in (0.125, 0.25))
    system = timed(PLANT, GAIN, ("0.5", "0.5"), delay)
    times = [("delay", 0.125), ("period", h), ("delay", 0.25), ("period", h)]
    found = along(system, times)[: len(expected) + 1]
    np.testing.assert_allclose(found, np.poly(expected), rtol=1e-6, atol=1e-8)


def random_loop(rng):
    """Return a loop of two states that random feedback often leaves near its border."""
    A = [[f"{a}/10" for a in row] for row in rng.integers(-30, 20, (2, 2))]
    K = [[f"{k}/20" for k in rng.integers(-40, 10, 2)]]
    first, width, late = rng.integers((1, 0, 0), (7, 7, 5))
    period = (Fraction(int(first), 10), Fraction(int(first + width), 10))
    delay = None if late == 0 else (Fraction(0), period[0] * Fraction(int(late), 4))
    return A, [["1/2"], ["1"]], K, period, delay


def worst_of(rng, A, B, K, ends, rate):
    """Return by how much random timings exceed a rate of decay, at most; one is not at all."""
    worst = 0.0
    for _ in range(60):
        signal = [
            [rng.choice(pair) if rng.random() < 0.6 else rng.uniform(*pair) for pair in ends]
            for _ in range(int(rng.integers(1, 7)))
        ]
        product = np.eye(len(A) + len(K))
        for h, d in signal:
            product = sampled(A, B, h, d, K) @ product
        claimed = np.exp(-rate * sum(h for h, _ in signal))
        worst = max(worst, float(max(abs(np.linalg.eigvals(product)))) / claimed)
    return worst


@pytest.mark.parametrize("seed", range(12))
def test_no_random_timing_is_beyond_what_is_proved(seed):
    """And what refutes is a sequence of timings of the loop, along which a motion grows."""
    rng = np.random.default_rng(seed)
    A, B, K, period, delay = random_loop(rng)
    system = timed((A, B), K, period, delay)
    found = certify(system, limits=Limits(optimize_rate=False, budget=2))
    A, B, K = map(floats, (A, B, K))
    ends = [[float(t) for t in times] for times in (period, delay or (0, 0))]
    if found.verdict is Verdict.INCONCLUSIVE:
        return
    assert found.evidence.find_fault(system) is None
    if found.verdict is Verdict.PROVED:
        assert worst_of(rng, A, B, K, ends, float(found.evidence.rate)) <= 1 + 1e-9
        return
    stays = {name: (stay.shortest, stay.longest) for name, stay in system.stays().items()}
    product, wait, steps = np.eye(3), 0.0, found.evidence.steps
    for name, time in (*steps[1:], steps[0]) if steps[0][0] == "period" else steps:
        assert stays[name][0] <= time <= stays[name][1]
        if name == "delay":
            wait = float(time)
        else:
            product, wait = sampled(A, B, float(time), wait, K) @ product, 0.0
    assert max(abs(np.linalg.eigvals(product))) > 1 - 1e-9
