"""No verdict under rules is against brute force: all short words that the rules let repeat.

The oracle knows the rules by their definition, and nothing of graphs, automata or forms.
"""

from dataclasses import replace
from fractions import Fraction
from itertools import groupby, pairwise, product

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.certificate import Verdict
from nrs_design.loop.assemble import modes_with_misses
from nrs_design.loop.located import LocatedMode, Period, Spot
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.spec.misses import MissesSpec
from tests.proof.systems import family
from tests.search.test_stays import timed

LIMITS = Limits(max_degree=4, budget=3.0, optimize_rate=False)
LONGEST, FEW = 7, 12
# What floating point may get wrong.
ROOM = 1e-7


def random_modes(rng, count, size):
    """Draw modes with decimals of one digit, of which a mean word neither grows nor decays much."""
    modes = rng.integers(-9, 10, (count, size, size))
    scale = Fraction(int(rng.integers(4, 15)), 100)
    return [[[scale * int(v) for v in row] for row in A] for A in modes]


class Stays:
    """Shortest and longest stays, and allowed switches."""

    def __init__(self, rng, count):
        shortest = rng.integers(1, 3, count)
        longest = [int(s + rng.integers(0, 3)) if rng.integers(2) else None for s in shortest]
        self.stays = list(zip([int(s) for s in shortest], longest, strict=True))
        pairs = [(a, b) for a in range(count) for b in range(count) if a != b]
        kept = [pair for pair in pairs if rng.integers(4)]
        self.switches = set(kept or pairs)

    def system(self, modes):
        stays = tuple(
            (f"m{k}", Stay(Fraction(a), b and Fraction(b))) for k, (a, b) in enumerate(self.stays)
        )
        switches = tuple((f"m{a}", f"m{b}") for a, b in sorted(self.switches))
        rules = Switching(transitions=switches, stays=stays)
        return family(*modes, time=Time.DISCRETE, switching=rules)

    def lets_repeat(self, word):
        runs = [(mode, len([*run])) for mode, run in groupby(word * (2 * LONGEST))]
        if len(runs) == 1:
            return self.stays[word[0]][1] is None
        return all(pair in self.switches for pair in pairwise(mode for mode, _ in runs)) and all(
            self.stays[mode][0] <= count <= (self.stays[mode][1] or count)
            for mode, count in runs[1:-1]
        )

    @staticmethod
    def mode_of(name):
        return int(name[1:])


class Misses:
    """At most some steps of a window in the second mode."""

    def __init__(self, rng):
        self.of = int(rng.integers(2, 5))
        self.most = int(rng.integers(1, self.of))

    def system(self, modes):
        first = family(*modes[:2], time=Time.DISCRETE)
        items = [
            LocatedMode(name, Spot.from_names(name), "", Period(mode.A.fractions()))
            for name, mode in zip(("hit", "miss"), first.modes, strict=True)
        ]
        rule = MissesSpec(mode="miss", at_most=self.most, of=self.of)
        each, rules = modes_with_misses(items, rule)
        return replace(first, modes=tuple(item.mode for item in each), switching=rules)

    def lets_repeat(self, word):
        long = word * (self.of + 1)
        windows = (long[k : k + self.of] for k in range(len(word)))
        return all(sum(window) <= self.most for window in windows) and max(word) <= 1

    @staticmethod
    def mode_of(name):
        return int(name.startswith("miss"))


def growth(word, matrices):
    whole = np.eye(len(matrices[0]))
    for k in word:
        whole = matrices[k] @ whole
    return np.abs(np.linalg.eigvals(whole)).max() ** (1 / len(word))


def word_of(evidence, rule):
    return tuple(rule.mode_of(name) for name, count in evidence.steps for _ in range(int(count)))


def check(seed):
    """Certify one random system, and compare with brute force; return the verdict."""
    rng = np.random.default_rng(seed)
    count, size = int(rng.integers(2, 4)), int(rng.integers(1, 4))
    modes = random_modes(rng, count, size)
    rule = Misses(rng) if seed % 3 == 0 else Stays(rng, count)
    system = rule.system(modes)
    matrices = np.array([[[float(v) for v in row] for row in A] for A in modes])
    known = 0.0
    for length in range(1, LONGEST + 1 - (count > 2)):
        for word in product(range(2 if seed % 3 == 0 else count), repeat=length):
            if rule.lets_repeat(word):
                known = max(known, growth(word, matrices))
    found = certify(system, limits=LIMITS)
    if found.verdict is Verdict.PROVED:
        assert known <= float(found.evidence.proved_rate(system)) + ROOM, seed
    if found.verdict is Verdict.REFUTED:
        assert_grows(found.evidence, rule, matrices, 1 - ROOM)
    return found.verdict


def assert_grows(evidence, rule, matrices, least):
    word = word_of(evidence, rule)
    assert rule.lets_repeat(word) or (len(set(word)) == 1 and rule.lets_repeat(word[:1]))
    assert growth(word, matrices) >= least


def check_timed(seed):
    """Certify modes that alternate with stays in a range; some signals are the oracle."""
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 4))
    modes = rng.integers(-30, 25, (2, size, size)) / 10
    stays = rng.integers(2, 20, 2) / 10
    width = float(rng.choice([0, 0.1, 0.3]))
    system = timed((str(width),) * 2, modes.astype(str), stays.astype(str))
    known = 0.0
    for length in (1, 1, 1, 2, 2, 3):
        whole = np.eye(size)
        for _ in range(length):
            for A, t in zip(modes, stays, strict=True):
                share = rng.choice([0, 1, rng.random()])
                whole = expm(A * t * (1 + width * share)) @ whole
        known = max(known, np.abs(np.linalg.eigvals(whole)).max())
    found = certify(system, limits=LIMITS)
    if found.verdict is Verdict.PROVED:
        assert known < 1 + ROOM, seed
    if found.verdict is Verdict.REFUTED:
        whole = np.eye(size)
        for name, time in found.evidence.steps:
            k = "ab".index(name)
            assert stays[k] - ROOM <= float(time) <= stays[k] * (1 + width) + ROOM
            whole = expm(modes[k] * float(time)) @ whole
        assert np.abs(np.linalg.eigvals(whole)).max() >= 1 - ROOM, seed
    return found.verdict


@pytest.mark.parametrize("part", range(6))
@pytest.mark.parametrize("one", [check, check_timed])
def test_no_verdict_is_wrong(one, part):
    verdicts = [one(seed) for seed in range(part * FEW, (part + 1) * FEW)]
    assert verdicts.count(Verdict.INCONCLUSIVE) <= 2


@pytest.mark.nightly
@pytest.mark.parametrize("part", range(40))
@pytest.mark.parametrize(("one", "count"), [(check, 250), (check_timed, 25)])
def test_no_verdict_of_thousands_is_wrong(one, count, part):
    """Ten thousand in all and a thousand of stays, nine of ten decided at least."""
    verdicts = [one(1000 + seed) for seed in range(part * count, (part + 1) * count)]
    assert verdicts.count(Verdict.INCONCLUSIVE) <= count // 10
