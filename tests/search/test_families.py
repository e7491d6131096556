"""Random families: for every one, whether a common quadratic function exists is decided.

Either answer is checked exactly, so none can be wrong; here, none may be missing either. The
shifts put the families on both sides of the threshold, and some near to it.
"""

from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from nrs_design.certificates.certificate import CommonQuadraticStatus, Verdict
from nrs_design.proof.evidence import NoCommonQuadratic
from nrs_design.proof.mode import Time
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.search.method import Method
from tests.support import family, holds, thinned

FEW, MORE, MANY = 30, 60, 400
SEEDS = [
    *range(FEW),
    *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(FEW, MORE)),
    *(pytest.param(seed, marks=pytest.mark.nightly) for seed in range(MORE, MANY)),
]
# The question is the one about quadratic functions: no higher degree is needed for its answer.
LIMITS = Limits(max_degree=2, optimize_rate=False)
DECIDED = {CommonQuadraticStatus.EXISTS, CommonQuadraticStatus.IMPOSSIBLE}


def draw(seed, n=None, m=None):
    """Return modes of one family with entries in thousandths, shifted to the left."""
    generator = np.random.default_rng([1994, seed])
    n = n or int(generator.integers(2, 13))
    m = m or int(generator.integers(2, 6))
    shift = generator.uniform(0.8, 2.2) * np.sqrt(n)
    matrices = generator.standard_normal((m, n, n)) - shift * np.eye(n)
    return [
        [[Fraction(round(1000 * entry), 1000) for entry in row] for row in A]
        for A in matrices.tolist()
    ]


def in_discrete_time(seed):
    generator = np.random.default_rng([2009, seed])
    n, m = int(generator.integers(2, 9)), int(generator.integers(2, 6))
    size = generator.uniform(0.3, 0.9) / np.sqrt(n)
    matrices = size * generator.standard_normal((m, n, n))
    return [
        [[Fraction(round(1000 * entry), 1000) for entry in row] for row in A]
        for A in matrices.tolist()
    ]


def times(modes, factor):
    return [[[factor * entry for entry in row] for row in A] for A in modes]


def shifted(modes, shift):
    return [
        [
            [entry - (shift if i == j else 0) for j, entry in enumerate(row)]
            for i, row in enumerate(A)
        ]
        for A in modes
    ]


def decide(modes, time=Time.CONTINUOUS):
    """Certify, insist on an answer, and hold it against the definition."""
    system = family(*modes, time=time)
    result = certify(system, limits=LIMITS)
    assert result.common_quadratic in DECIDED, [a.outcome for a in result.attempts]
    assert all(holds(system, statement) for statement in result.statements)
    shown = [isinstance(item, NoCommonQuadratic) for item in result.statements]
    if result.common_quadratic is CommonQuadraticStatus.EXISTS:
        assert result.verdict is Verdict.PROVED
        assert not any(shown)
    else:
        assert any(shown) or result.verdict is Verdict.REFUTED
    return result.common_quadratic


@pytest.mark.parametrize("seed", SEEDS)
def test_every_family_is_decided(seed):
    decide(draw(seed))


@pytest.mark.parametrize("seed", SEEDS[:FEW:2] + SEEDS[FEW::4])
def test_every_family_in_discrete_time_is_decided(seed):
    decide(in_discrete_time(seed), Time.DISCRETE)


@pytest.mark.slow
def test_both_answers_are_common():
    """What stands above says something only if the families are of both sorts."""
    for modes, time in ((draw, Time.CONTINUOUS), (in_discrete_time, Time.DISCRETE)):
        answers = [decide(modes(seed), time) for seed in range(12)]
        assert set(answers) == DECIDED


@pytest.mark.slow
def test_a_pair_of_order_30():
    """A'Q + QA = -S with Q random: far beyond what the families above reach."""
    rng = np.random.default_rng(30)
    n, identity = 30, np.eye(30)
    R, K, G = rng.standard_normal((3, 2, n, n))
    Q = R[0] @ R[0].T / n + 0.3 * identity
    S = G @ G.swapaxes(1, 2) / n + 0.3 * identity
    modes = np.linalg.solve(Q, K - K.swapaxes(1, 2) - S / 2)
    exact = [[[Fraction(round(1000 * a), 1000) for a in row] for row in A] for A in modes.tolist()]
    result = certify(family(*exact), Method.LMI, Limits(optimize_rate=False))
    assert result.common_quadratic is CommonQuadraticStatus.EXISTS
    assert all(holds(result.system, statement) for statement in result.statements)


@pytest.mark.parametrize("factor", ["100000", "1/100000"])
@pytest.mark.parametrize("seed", SEEDS[:6] + SEEDS[FEW : FEW + 6])
def test_unit_of_time_changes_nothing(seed, factor):
    modes = draw(seed)
    assert decide(times(modes, Fraction(factor))) is decide(modes)


@cache
def bracket(seed, steps):
    """Bisect for the shift at which a common quadratic function begins to exist."""
    modes = draw(seed, n=2 + seed % 5)
    low, high = Fraction(-8), Fraction(8)
    for _ in range(steps):
        middle = (low + high) / 2
        if decide(shifted(modes, middle)) is CommonQuadraticStatus.EXISTS:
            high = middle
        else:
            low = middle
    return low, high


@pytest.mark.parametrize(
    "seed", [0, 2, *(pytest.param(s, marks=pytest.mark.slow) for s in (1, *range(3, 13)))]
)
def test_near_the_threshold(seed):
    """Every shift on the way is decided, down to a millionth of the size of the modes."""
    low, high = bracket(seed, 24)
    assert 0 < high - low <= Fraction(1, 10**6)


def near_root_of_two(bits):
    """Return convergents of sqrt(2) from below and above, about 2^-bits from each other."""
    p, q = 1, 1
    while q < 2 ** (bits // 2):
        p, q = p + 2 * q, p + q
    return sorted((Fraction(p, q), Fraction(2 * q, p)))


def dayawansa_martin_at(root):
    """The pair at ``a = 3 + 2 root``: quadratic iff the root is below that of two."""
    a = 3 + 2 * root
    return [[[-1, -1], [1, -1]], [[-1, -a], [1 / a, -1]]]


@pytest.mark.parametrize("bits", thinned([8, 24, 16, 20], 2))
def test_threshold_of_dayawansa_and_martin(bits):
    below, above = map(dayawansa_martin_at, near_root_of_two(bits))
    assert decide(below) is CommonQuadraticStatus.EXISTS
    assert decide(above) is CommonQuadraticStatus.IMPOSSIBLE


@pytest.mark.parametrize(
    "bits", [30, *(pytest.param(bits, marks=pytest.mark.slow) for bits in (60, 200))]
)
def test_never_wrong_beyond_the_digits_of_floating_point(bits):
    below, above = (family(*dayawansa_martin_at(root)) for root in near_root_of_two(bits))
    for system, wrong in (
        (below, CommonQuadraticStatus.IMPOSSIBLE),
        (above, CommonQuadraticStatus.EXISTS),
    ):
        result = certify(system, limits=LIMITS)
        assert result.common_quadratic is not wrong
        assert result.verdict is not Verdict.REFUTED
