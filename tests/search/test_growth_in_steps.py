"""Growing cycles in discrete time, under rules: against known limits."""

from dataclasses import replace
from fractions import Fraction
from itertools import combinations, permutations

import numpy as np
import pytest

from nrs_design.proof.evidence import GrowingSequence
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.certify import Limits, Verdict, certify
from nrs_design.search.graph import Jump, elementary_cycles
from nrs_design.search.period import search_period
from tests.proof import systems
from tests.proof.truth import holds
from tests.search.support import found
from tests.tables import by_rows

FAST = Limits(max_degree=4, budget=5.0, optimize_rate=False)


def shears(dwell, **rules):
    """``A^j B^k`` has the trace ``2^-(j+k) (2 + 16 j k)`` and the determinant ``4^-(j+k)``.

    So it grows iff ``2 + 16 j k > 2^(j+k) + 2^-(j+k)``: for j = k = 4 by 258 to 256, and for no j
    and k of at least 4 and 5 or more.
    """
    pair = [["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]]
    return systems.family(*pair, time=Time.DISCRETE, switching=Switching(Fraction(dwell), **rules))


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
    system = systems.family(turn, [["1/2", 2], [0, "1/2"]], time=Time.DISCRETE)
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

    return systems.family(
        *map(step, range(count)), time=Time.DISCRETE, switching=Switching(**rules)
    )


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
        resets = systems.resets_between(("m0", "m1", [[gain]]))
        system = systems.family(half, half, time=Time.DISCRETE, switching=Switching(resets=resets))
        found = search(system)
        # Two steps and one reset: gain/4.
        assert (found is not None) is (grows and gain == "5")
        slow = replace(system, switching=Switching(Fraction(2), resets=resets))
        assert search(slow) is None


def test_resets_in_coordinates_of_the_spec():
    """Badly scaled states: the search must not mix its own scaling with the resets."""
    big = Fraction(10) ** 6
    pair = [["1/2", 2 * big], [0, "1/2"]], [["1/2", 0], [2 / big, "1/2"]]
    swap = systems.resets_between(("m0", "m1", [["11/10", 0], [0, "11/10"]]))
    system = systems.family(
        *pair, time=Time.DISCRETE, switching=Switching(Fraction(3), resets=swap)
    )
    found = search(system)
    assert found is not None
    assert found.find_fault(system) is None


def test_both_ends_of_a_constant_parameter_are_never_mixed():
    c = "0.9"
    pair = [[c, c], [0, c]], [[c, 0], [c, c]]
    low = [["1/4", 0], [0, "1/4"]]
    apart = Switching(fixed_ends=(("m0", "m1"), ("m2", "m3")))
    system = systems.family(pair[0], low, low, pair[1], time=Time.DISCRETE, switching=apart)
    assert search(system) is None
    together = systems.family(pair[0], low, pair[1], low, time=Time.DISCRETE, switching=apart)
    assert {name for name, _ in search(together).steps} == {"m0", "m2"}


def test_words_are_searched_where_any_mode_may_follow_any():
    evidence = search(systems.golden("0.6181"))
    assert all(steps == 1 for _, steps in evidence.steps)
    assert search(systems.golden("0.618")) is None


def jumps(*pairs):
    return [Jump(a, b, 0, np.eye(1)) for a, b in pairs]


def cycles_of(pairs):
    found = jumps(*pairs)
    return [tuple(found[k].source for k in cycle) for cycle in elementary_cycles(found)]


@pytest.mark.parametrize("seed", range(12))
def test_all_elementary_cycles_of_small_graphs(seed):
    rng = np.random.default_rng(seed)
    m = int(rng.integers(2, 6))
    pairs = [pair for pair in permutations(range(m), 2) if rng.random() < 0.5]
    expected = {
        (chosen[0], *rest)
        for count in range(2, m + 1)
        for chosen in combinations(range(m), count)
        for rest in permutations(chosen[1:])
        if set(zip((chosen[0], *rest), (*rest, chosen[0]), strict=True)) <= set(pairs)
    }
    found = cycles_of(pairs)
    assert len(found) == len(set(found))
    assert set(found) == expected
    assert [len(cycle) for cycle in found] == sorted(len(cycle) for cycle in found)


def test_parallel_jumps_make_cycles_of_their_own():
    found = list(elementary_cycles(jumps((0, 1), (0, 1), (1, 0))))
    assert found == [(0, 2), (1, 2)]


def test_a_ring_with_dead_ends():
    ring = [(k, (k + 1) % 30) for k in range(30)]
    assert cycles_of([*ring, *((k, 30 + k) for k in range(30))]) == [tuple(range(30))]
    assert cycles_of(ring[:-1]) == []


def turning(count, gain, **rules):
    """Each mode decays, and feeds the next state of a ring from one state."""

    def mode(k):
        return [
            [gain if (i, j) == ((k + 1) % count, k) else -int(i == j) for j in range(count)]
            for i in range(count)
        ]

    return systems.family(*map(mode, range(count)), switching=Switching(**rules))


@pytest.mark.slow
@pytest.mark.parametrize("count", [3, 5, 9])
def test_around_a_ring_in_continuous_time(count):
    around = tuple((f"m{k}", f"m{(k + 1) % count}") for k in range(count))
    found = certify(turning(count, 20, transitions=around), limits=FAST)
    assert found.verdict is Verdict.REFUTED
    assert {name for name, _ in found.evidence.steps} == {f"m{k}" for k in range(count)}
    assert holds(found.system, found.evidence)
    open_ended = certify(turning(count, 20, transitions=around[:-1]), limits=FAST)
    assert open_ended.verdict is not Verdict.REFUTED


def tripled(*modes, **rules):
    """A reset by 3 at every switch between two scalar modes."""
    resets = systems.resets_between(("m0", "m1", [[3]]), ("m1", "m0", [[3]]))
    return systems.family(*([[a]] for a in modes), switching=Switching(resets=resets, **rules))


# Per round, growth by 9 and decay by exp(-both stays): ln 9 = 2.1972...
@pytest.mark.parametrize(
    ("rules", "verdict"),
    [
        ({}, Verdict.REFUTED),
        ({"dwell_time": Fraction("1.09")}, Verdict.REFUTED),
        ({"dwell_time": Fraction("1.11")}, Verdict.PROVED),
        ({"stays": (("m0", Stay(Fraction("2.19"))),)}, Verdict.REFUTED),
        ({"stays": (("m1", Stay(Fraction("2.2"))),)}, Verdict.PROVED),
        ({"stays": (("m1", Stay(Fraction(2), Fraction("2.1"))),)}, Verdict.REFUTED),
        ({"transitions": (("m0", "m1"),)}, Verdict.PROVED),
    ],
)
def test_resets_at_every_switch_in_continuous_time(rules, verdict):
    found = certify(tripled(-1, -1, **rules), limits=FAST)
    assert found.verdict is verdict
    assert holds(found.system, found.evidence)


@by_rows("system", "verdict", system=systems.built)
def test_what_must_be_left_and_the_worst_of_two_resets(system, verdict):
    found = certify(system, limits=FAST)
    assert found.verdict == verdict
    assert found.evidence is None or holds(system, found.evidence)
    if system.switching.resets and verdict == "refuted":
        assert found.evidence.edges == (1, 0)


@pytest.mark.parametrize("time", list(Time))
def test_two_resets_in_turn(time):
    """Each reset alone, taken twice, makes the state zero."""
    decay = [[-1, 0], [0, -1]] if time is Time.CONTINUOUS else [["1/2", 0], [0, "1/2"]]
    turns = systems.resets_between(("m0", "m1", [[0, 5], [0, 0]]), ("m0", "m1", [[0, 0], [5, 0]]))
    system = systems.family(decay, decay, time=time, switching=Switching(resets=turns))
    found = certify(system, limits=FAST)
    assert found.verdict is Verdict.REFUTED
    assert sorted(found.evidence.edges) == [0, 0, 0, 1]
    assert holds(system, found.evidence)
    alone = replace(system, switching=Switching(resets=turns[:1]))
    assert certify(alone, limits=FAST).verdict is not Verdict.REFUTED


def slowest_growth(system, legs):
    """Return the largest growth per step over all cycles with so many legs, by trying all stays."""
    matrices = {mode.name: np.array(mode.A.floats()) for mode in system.modes}
    stays, best = system.stays(), 0.0
    walks = [((edge,), np.eye(system.order), 0) for edge in system.edges()]
    for _ in range(legs):
        longer = []
        for path, product, steps in walks:
            stay = stays[path[-1].source.name]
            end = int(stay.longest) if stay.longest is not None else int(stay.shortest) + 3
            for count in range(int(stay.shortest), end + 1):
                reset = np.eye(system.order) if path[-1].map is None else path[-1].map.floats()
                power = np.linalg.matrix_power(matrices[path[-1].source.name], count)
                whole = np.array(reset) @ power @ product
                if path[-1].target is path[0].source:
                    radius = np.abs(np.linalg.eigvals(whole)).max()
                    best = max(best, float(radius) ** (1 / (steps + count)))
                longer += [
                    ((*path, edge), whole, steps + count)
                    for edge in system.edges()
                    if edge.source is path[-1].target
                ]
        walks = longer
    return best


def random_graph(seed):
    """Draw three modes, some of them unstable but left in time, and some parallel resets."""
    rng = np.random.default_rng(seed)
    pairs = [(0, 1), (1, 2), (2, 0), (1, 0)]
    names = [(f"m{a}", f"m{b}") for a, b in pairs]
    maps = rng.integers(-8, 9, size=(3, 2, 2))
    resets = systems.resets_between(
        *((*names[int(rng.integers(0, 2))], [[Fraction(int(v), 8) for v in row] for row in G])
          for G in maps)
    )  # fmt: skip
    low, high = int(rng.integers(1, 3)), int(rng.integers(0, 3))
    stays = (
        ("m0", Stay(Fraction(low), Fraction(low + high))),
        ("m1", Stay(Fraction(1), Fraction(2))),
    )
    matrices = rng.integers(-9, 10, size=(3, 2, 2)) / 9
    matrices[2] /= max(1.0, 1.2 * np.abs(np.linalg.eigvals(matrices[2])).max())
    modes = [[[Fraction(round(100 * v), 100) for v in row] for row in A] for A in matrices]
    rules = Switching(transitions=tuple(names), resets=resets, stays=stays)
    return systems.family(*modes, time=Time.DISCRETE, switching=rules)


@pytest.mark.slow
def test_random_graphs_against_all_short_cycles():
    counts = dict.fromkeys(Verdict, 0)
    for seed in range(25):
        system = random_graph(seed)
        growth = slowest_growth(system, 3)
        found = certify(system, limits=FAST)
        counts[found.verdict] += 1
        if found.verdict is Verdict.PROVED:
            assert growth <= float(found.evidence.proved_rate(system)) * (1 + 1e-9)
        if found.evidence is not None:
            assert holds(system, found.evidence)
        assert growth < 1 + 1e-6 or found.verdict is Verdict.REFUTED
    assert counts[Verdict.PROVED] > 3
    assert counts[Verdict.REFUTED] > 3
