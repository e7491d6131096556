"""Modes of a loop in intervals of time, against the textbook's map from sample to sample."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.certificate import Verdict
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.spec import parse_spec
from nrs_design.switched.assemble import assemble_matrices

CONTROLLER = "{A: [[0.5, 1], [0, 0.25]], B: [[1], [0.5]], C: [[-2, 1], [0, 3]], D: [[-1], [0.5]]}"
TWO_INPUTS = ([[0, 1], [-2, "-0.3"]], [[0, 1], [1, "0.5"]])


def matrix(rows):
    return "[" + ", ".join("[" + ", ".join(f'"{e}"' for e in row) + "]" for row in rows) + "]"


def timed(plant, controller, period, delay=None, C=None):
    """Return the system of a loop whose times are in s, with both ends."""
    A, B = map(matrix, plant)
    C = "" if C is None else f", C: {matrix(C)}"
    late = "" if delay is None else f", delay: [{delay[0]} s, {delay[1]} s]"
    return assemble_matrices(
        parse_spec(
            f"kind: sampled-system\nname: loop\nplant: {{A: {A}, B: {B}{C}}}\n"
            f"controller: {controller}\n"
            f"sampling: {{period: [{period[0]} s, {period[1]} s]{late}}}\n"
        )
    )


def floats(rows):
    return np.array([[float(Fraction(str(e))) for e in row] for row in rows])


def sampled(A, B, h, d, feedback):
    """Return the map of (x, z, u) from a sample to the next, by both parts of the period.

    ``feedback`` gives the rows of (z, u) after a sample, over (x, z).
    """
    n, m = B.shape
    p = len(feedback) - m
    parts = []
    for time in (d, h - d):
        E = expm(np.block([[A, B], [np.zeros((m, n + m))]]) * time)
        parts.append((E[:n, :n], E[:n, n:]))
    (E1, G1), (E2, G2) = parts
    x = np.eye(n, n + p + m)
    z, u = np.split(np.hstack([feedback, np.zeros((p + m, m))]), [p])
    held = np.eye(n + p + m)[n + p :]
    return np.vstack([E2 @ (E1 @ x + G1 @ held) + G2 @ u, z, u])


def along(system, times):
    """Return the product along stays of these lengths, each followed by its reset."""
    modes = {mode.name: np.array(mode.A.floats()) for mode in system.modes}
    maps = {reset.source: np.array(reset.map.floats()) for reset in system.switching.resets}
    product = np.eye(system.order)
    for name, time in times:
        product = maps[name] @ expm(modes[name] * time) @ product
    return product


def closed(product):
    """Return the eigenvalues but zeros, which the states for the delay add."""
    values = np.linalg.eigvals(product)
    return np.sort_complex(values[np.abs(values) > 1e-9])


@pytest.mark.parametrize("late", [False, True])
@pytest.mark.parametrize("dynamic", [False, True])
def test_the_map_from_sample_to_sample(late, dynamic):
    A, B = map(floats, TWO_INPUTS)
    if dynamic:
        C = np.array([[1.0, -0.5]])
        z = np.hstack([np.array([[1.0], [0.5]]) @ C, np.array([[0.5, 1], [0, 0.25]])])
        u = np.hstack([np.array([[-1.0], [0.5]]) @ C, np.array([[-2.0, 1], [0, 3]])])
        feedback, said = np.vstack([z, u]), (CONTROLLER, [[1, "-0.5"]])
    else:
        feedback, said = (
            np.array([[-1.0, -0.5], [0.25, -1]]),
            ('{K: [[-1, "-0.5"], [0.25, -1]]}', None),
        )
    delay = (0, "0.4") if late else None
    system = timed(TWO_INPUTS, said[0], ("0.5", 2), delay, said[1])
    rng = np.random.default_rng(0)
    order = 2 + 2 * dynamic + 2
    expected, times = np.eye(order), []
    for k in range(4):
        h, d = rng.uniform(0.5, 2), rng.uniform(0, 0.4) * late
        expected = sampled(A, B, h, d, feedback) @ expected
        times += [("delay", d), ("period", h)] if late else [(f"period/{k % 2 + 1}", h)]
    # A stay ends with the sample after it: the products are in the same order, a part later.
    np.testing.assert_allclose(closed(along(system, times)), closed(expected), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("rest", [("0.1", "0.3"), ("0", "0.5"), ("0.2", "0.2"), None])
def test_a_whole_period_of_a_delay_is_a_state_of_the_controller(rest):
    """By hand, z+ = K y and u = z."""
    late = None if rest is None else tuple(str(Fraction(end) + Fraction(1, 2)) for end in rest)
    K = [["-1", "-0.5"], ["0.25", "-1"]]
    own = timed(TWO_INPUTS, f"{{K: {matrix(K)}}}", ("0.5", "0.5"), late or ("0.5", "0.5"))
    zero, unit = [[0, 0], [0, 0]], [[1, 0], [0, 1]]
    by_hand = f"{{A: {matrix(zero)}, B: {matrix(K)}, C: {matrix(unit)}}}"
    other = timed(TWO_INPUTS, by_hand, ("0.5", "0.5"), rest)
    assert own.modes == other.modes
    assert own.switching == other.switching
    assert "waiting2" in own.states
    assert "1 whole period" in own.assumptions[-1]


@pytest.mark.parametrize("whole", [1, 2, 3])
def test_commands_that_wait(whole):
    """Delays of more periods, and a controller with states: registers around the same law."""
    A, B = map(floats, TWO_INPUTS)
    C, h = np.array([[1.0, -0.5]]), 0.5
    z = np.hstack([np.array([[1.0], [0.5]]) @ C, np.array([[0.5, 1], [0, 0.25]])])
    law = np.hstack([np.array([[-1.0], [0.5]]) @ C, np.array([[-2.0, 1], [0, 3]])])
    size = 2 * whole
    shift = np.hstack([np.zeros((size, 4)), np.vstack([np.zeros((2, size)), np.eye(size)[:-2]])])
    shift[:2, :4] += law
    oldest = np.hstack([np.zeros((2, 4)), np.eye(size)[-2:]])
    feedback = np.vstack([np.hstack([z, np.zeros((2, size))]), shift, oldest])
    delay = (str(whole * h + 0.125), str(whole * h + 0.25))
    system = timed(TWO_INPUTS, CONTROLLER, ("0.5", "0.5"), delay, [[1, "-0.5"]])
    expected = sampled(A, B, h, 0.25, feedback) @ sampled(A, B, h, 0.125, feedback)
    times = [("delay", 0.125), ("period", h), ("delay", 0.25), ("period", h)]
    found = np.poly(along(system, times))[: len(expected) + 1]
    np.testing.assert_allclose(found, np.poly(expected), rtol=1e-6, atol=1e-8)


def test_names_of_states_and_stays():
    system = timed(TWO_INPUTS, CONTROLLER, ("0.5", 2), ("0.1", "0.4"), [[1, 0]])
    assert system.states == ("x1", "x2", "late1", "late2", "z1", "z2", "u1", "u2")
    stays = {name: (stay.shortest, stay.longest) for name, stay in system.stays().items()}
    assert stays == {
        "delay": (Fraction(1, 10), Fraction(2, 5)),
        "period": (Fraction(1, 2), Fraction(2)),
    }
    at_once = timed(TWO_INPUTS, CONTROLLER, ("0.5", 2), None, [[1, 0]])
    assert at_once.states == ("x1", "x2", "z1", "z2", "u1", "u2")
    assert [mode.name for mode in at_once.modes] == ["period/1", "period/2"]


def test_what_is_taken_for_granted():
    _, period, delay = timed(
        TWO_INPUTS, CONTROLLER, ("0.5", 2), ("0.1", "0.1"), [[1, 0]]
    ).assumptions
    assert period.startswith("From a sample to the next it takes 0.5 to 2 s")
    assert delay.startswith("From a sample to where its command takes effect it takes 0.1 s")
    assert (period.bound, delay.id) == ("period: it takes 0.5 to 2 s", "timing.delay")


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
    """And what refutes is a sequence of timings of the spec, along which a motion grows."""
    rng = np.random.default_rng(seed)
    A, B, K, period, delay = random_loop(rng)
    system = timed((A, B), f"{{K: {matrix(K)}}}", period, delay)
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
