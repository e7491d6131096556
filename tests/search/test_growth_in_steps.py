"""Growing cycles in discrete time, under rules: against known limits."""

from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.search.certify import Limits, Verdict, certify
from nrs_design.search.period import search_period
from tests.proof.systems import family, golden, resets_between
from tests.proof.truth import holds
from tests.search.support import found

FAST = Limits(max_degree=4, budget=5.0, optimize_rate=False)


def shears(dwell, **rules):
    """``A^j B^k`` has the trace ``2^-(j+k) (2 + 16 j k)`` and the determinant ``4^-(j+k)``.

    So it grows iff ``2 + 16 j k > 2^(j+k) + 2^-(j+k)``: for j = k = 4 by 258 to 256, and for no j
    and k of at least 4 and 5 or more.
    """
    pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
    return family(*pair, time=Time.DISCRETE, switching=Switching(Fraction(dwell), **rules))


def search(system):
    return found(search_period, system)


@pytest.mark.parametrize("dwell", range(2, 8))
def test_known_limit_of_the_dwell_time(dwell):
    system = shears(dwell)
    found = certify(system, limits=FAST)
    assert found.verdict is (Verdict.REFUTED if dwell <= 4 else Verdict.PROVED)
    assert holds(system, found.evidence)
    if dwell <= 4:
        assert found.evidence.doublings is not None
        assert all(steps >= dwell for _, steps in found.evidence.steps)


@pytest.mark.parametrize(
    "steps", [(3, 4), (4, 3), (2, 5), (3, 3), (1, 1)], ids=lambda steps: "-".join(map(str, steps))
)
def test_a_cycle_that_breaks_the_dwell_time_refutes_nothing(steps):
    grows = GrowingSequence(tuple(zip(("m0", "m1"), map(Fraction, steps), strict=True)), 12)
    assert grows.find_fault(shears(1)) is None
    assert grows.find_fault(shears(4)) is not None


def test_legs_longer_than_the_dwell_time():
    """A turn by 5 degrees per step, and a shear: they grow with enough turns, not with 2."""
    turn = [["0.98623", "-0.08628"], ["0.08628", "0.98623"]]
    system = family(turn, [["1/2", 2], [0, "1/2"]], time=Time.DISCRETE)
    system = replace(system, switching=Switching(Fraction(2)))
    short = GrowingSequence((("m0", Fraction(2)), ("m1", Fraction(2))), 12)
    assert short.find_fault(system) is not None
    found = search(system)
    assert found.find_fault(system) is None
    assert holds(system, found)
    assert max(steps for _, steps in found.steps) > 2


def ring(count, gain, **rules):
    """Each mode passes the state on to the next of a ring and forgets it everywhere else."""

    def step(k):
        target = (k + 1) % count
        return [[gain * int(i == target and j == k) for j in range(count)] for i in range(count)]

    return family(*map(step, range(count)), time=Time.DISCRETE, switching=Switching(**rules))


@pytest.mark.slow
@pytest.mark.parametrize(("gain", "grows"), [("1.01", True), ("0.99", False)])
def test_around_a_ring_of_allowed_switches(gain, grows):
    around = tuple((f"m{k}", f"m{(k + 1) % 5}") for k in range(5))
    found = search(ring(5, Fraction(gain), transitions=around))
    assert (found is not None) is grows
    if grows:
        assert {name for name, _ in found.steps} == {f"m{k}" for k in range(5)}
    against = tuple((b, a) for a, b in around)
    assert search(ring(5, Fraction(gain), transitions=against)) is None
    assert search(ring(5, Fraction(gain), transitions=around[:-1])) is None


def test_resets_count():
    """Modes that halve the state, and a reset that trebles it."""
    half = [["1/2"]]
    for gain, grows in (("5", True), ("4", True), ("3.9", False)):
        resets = resets_between(("m0", "m1", [[gain]]))
        system = family(half, half, time=Time.DISCRETE, switching=Switching(resets=resets))
        found = search(system)
        # Two steps and one reset: gain/4.
        assert (found is not None) is (grows and gain == "5")
        slow = replace(system, switching=Switching(Fraction(2), resets=resets))
        assert search(slow) is None


def test_resets_in_coordinates_of_the_spec():
    """Badly scaled states: the search must not mix its own scaling with the resets."""
    big = Fraction(10) ** 6
    pair = [["1/2", 2 * big], [0, "1/2"]], [["1/2", 0], [2 / big, "1/2"]]
    swap = resets_between(("m0", "m1", [["11/10", 0], [0, "11/10"]]))
    system = family(*pair, time=Time.DISCRETE, switching=Switching(Fraction(3), resets=swap))
    found = search(system)
    assert found is not None
    assert found.find_fault(system) is None


def test_both_ends_of_a_constant_parameter_are_never_mixed():
    c = "0.9"
    pair = [[c, c], [0, c]], [[c, 0], [c, c]]
    low = [["1/4", 0], [0, "1/4"]]
    apart = Switching(fixed_ends=(("m0", "m1"), ("m2", "m3")))
    system = family(pair[0], low, low, pair[1], time=Time.DISCRETE, switching=apart)
    assert search(system) is None
    together = family(pair[0], low, pair[1], low, time=Time.DISCRETE, switching=apart)
    assert {name for name, _ in search(together).steps} == {"m0", "m2"}


def test_words_are_searched_where_any_mode_may_follow_any():
    evidence = search(golden("0.6181"))
    assert all(steps == 1 for _, steps in evidence.steps)
    assert search(golden("0.618")) is None
