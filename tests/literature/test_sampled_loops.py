"""Sampled loops whose periods and delays vary: published examples, from both sides.

Constant periods have borders that anyone can compute: where the map from a sample to the next has
an eigenvalue of modulus one. Proofs are for any sequence in the interval, and come close to them.
"""

from fractions import Fraction

import numpy as np
import pytest
from scipy.optimize import brentq

from nrs_design.certificates.certificate import Verdict
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from tests.literature.timed_loop import floats, sampled, timed
from tests.tables import rows

# Zhang, Branicky and Phillips, IEEE Control Systems Magazine 21(1), 2001; since then of Fridman,
# Seuret and Richard, Automatica 40(8), 2004; Naghshtabrizi, Hespanha and Teel, Systems and Control
# Letters 57(5), 2008, and others: variable periods of up to 0.87 s, 1.11 s and later 1.729 s.
INTEGRATOR = ([[0, 1], [0, "-0.1"]], [[0], ["0.1"]]), [["-3.75", "-11.5"]]
# The same authors, and Hetel and others, Automatica 76, 2017: periods of 0.18 s and of 0.54 s are
# stable, and not in turn.
IN_TURN = ([[1, 3], [2, 1]], [[1], ["0.6"]]), [[-1, -6]]
# Cloosterman, van de Wouw, Heemels and Nijmeijer, IEEE Conference on Decision and Control, 2006: a
# mass that a motor moves, n r_R / (J_M + n^2 J_R) = 126.7, every 1 ms; delays of 0.2 ms and of 0.6
# ms are stable, and not in turn.
MOTION = ([[0, 1], [0, 0]], [[0], ["126.7"]]), [[-50, "-11.8"]]


def decide(loop, period, delay=None, **limits):
    plant, K = loop
    system = timed(plant, K, period, delay)
    found = certify(system, limits=Limits(**limits))
    if found.evidence is not None:
        assert found.evidence.find_fault(system) is None
    return found


def radius(loop, *timings):
    (A, B), K = loop
    A, B, K = map(floats, (A, B, K))
    product = np.eye(len(A) + len(K))
    for h, d in timings:
        product = sampled(A, B, h, d, K) @ product
    return float(max(abs(np.linalg.eigvals(product))))


def border(loop, of, low, high):
    return brentq(lambda t: radius(loop, of(t)) - 1, low, high, xtol=1e-12)


def test_the_border_of_constant_periods():
    assert border(INTEGRATOR, lambda h: (h, 0), 1.6, 1.8) == pytest.approx(1.729414279, abs=1e-8)


@pytest.mark.parametrize(
    ("shortest", "longest", "verdict"), rows(__file__, "test_periods_that_vary")
)
def test_periods_that_vary(shortest, longest, verdict):
    """Up to the border of constant periods, which no proof can pass: 1.72941."""
    found = decide(INTEGRATOR, (shortest, longest), optimize_rate=False)
    assert found.verdict == verdict


def test_the_decay_is_below_that_of_every_constant_period():
    found = decide(INTEGRATOR, ("0.1", "1.7"))
    slowest = min(-np.log(radius(INTEGRATOR, (h, 0))) / h for h in np.linspace(0.1, 1.7, 33))
    assert 0.85 * slowest < float(found.evidence.rate) < slowest


def test_periods_in_turn():
    assert max(radius(IN_TURN, (h, 0)) for h in (0.18, 0.54)) < 0.8
    assert radius(IN_TURN, (0.18, 0), (0.54, 0)) == pytest.approx(1.005, abs=5e-4)
    assert decide(IN_TURN, ("0.18", "0.54")).verdict is Verdict.REFUTED
    assert decide(IN_TURN, ("0.2", "0.5")).verdict is Verdict.PROVED


def test_delays_in_turn():
    assert radius(MOTION, (1e-3, 0.2e-3)) < 0.996 > radius(MOTION, (1e-3, 0.6e-3))
    assert radius(MOTION, (1e-3, 0.2e-3), (1e-3, 0.6e-3)) > 1.01
    refuted = decide(MOTION, ("1e-3", "1e-3"), ("0.2e-3", "0.6e-3"))
    assert refuted.verdict is Verdict.REFUTED
    delays = [time for name, time in refuted.evidence.steps if name == "delay"]
    # One delay alone does not do.
    assert len(set(delays)) > 1
    assert all(Fraction("0.2e-3") <= delay <= Fraction("0.6e-3") for delay in delays)
    for longest in ("0.4e-3", "0.5e-3"):
        found = decide(MOTION, ("1e-3", "1e-3"), (0, longest), optimize_rate=False)
        assert found.verdict is Verdict.PROVED


def test_a_constant_delay_against_its_border():
    last = border(MOTION, lambda d: (1e-3, d), 0.5e-3, 0.9e-3)
    for share, verdict in ((0.999, Verdict.PROVED), (1.001, Verdict.REFUTED)):
        delay = str(round(share * last, 9))
        assert decide(MOTION, ("1e-3", "1e-3"), (delay, delay)).verdict is verdict


@pytest.mark.parametrize(
    ("period", "delay", "verdict"), rows(__file__, "test_one_integrator_by_hand")
)
def test_one_integrator_by_hand(period, delay, verdict):
    found = decide((([[0]], [[1]]), [[-1]]), period, delay, optimize_rate=False)
    assert found.verdict == verdict


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
