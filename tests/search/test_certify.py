"""The whole search on families whose answer is known; lying solvers; hard numbers.

The verdict may be inconclusive where numbers are extreme. It may never be wrong.
"""

import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from itertools import count, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.certificates.certificate import CommonQuadraticStatus, Verdict
from nrs_design.errors import ClockError, DesignError, InternalError
from nrs_design.proof.evidence import BlockTriangular, FormsOnGraph, Shows
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.search import gradient, ladder, unstable_mode
from nrs_design.search.acceptance import Candidate, first_accepted
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.search.drawing import Solution
from nrs_design.search.forms import FormsProgram
from nrs_design.search.gradient import GradientResult
from nrs_design.search.method import Method
from nrs_design.search.sdp import Maximum, SemidefiniteProgram
from tests.proof.graphs import common_quadratic, shape_of
from tests.support import dayawansa_martin, family, holds
from tests.tables import by_rows

ROTATION = [[0, 1], [-1, 0]]
SINGULAR = [["-0.36", "-0.48"], ["-0.48", "-0.64"]]
STABLE = dayawansa_martin(5)
MARGINAL = family([[-1, 0], [0, -1]], ROTATION)
UNSTABLE = family([[-1, 0], [0, -1]], [[1, 0], [0, -1]])
NOT_QUADRATIC = dayawansa_martin(6)
SHEARS = family([[-1, 10], [0, -1]], [[-1, 0], [10, -1]])
SLOW = replace(dayawansa_martin(12), switching=Switching(dwell_time=Fraction(10)))
CONSTANT = replace(dayawansa_martin(12), switching=Switching(fixed_ends=(("m0", "m1"),)))
DISCRETE = family([["1/2", 1], [0, "1/2"]], [["1/2", 0], [0, "-1/2"]], time=Time.DISCRETE)
DISCRETE_METHODS = [
    Method.LMI,
    Method.OBSTRUCTION,
    Method.MODE_QUADRATIC,
    Method.PERIOD,
    Method.POLYNOMIAL,
]
UNSTABLE_BLOCK = [[-1, 0, 0], [0, -1, 0], [0, 0, 1]]


def slow(value):
    """Leave a case to the slow tests."""
    return pytest.param(value, marks=pytest.mark.slow)


def ando_shih(c):
    """Joint spectral radius c, but no quadratic function beyond 0.7071 (Ando and Shih 1998)."""
    return [[c, 0], [c, 0]], [[0, c], [0, f"-{c}"]]


@pytest.mark.slow
@by_rows("asked", "method")
def test_a_search_goes_on_until_the_decay_that_is_asked_for(asked, method):
    rate = None if asked is None else Fraction(asked)
    found = certify(STABLE, limits=Limits(decay_rate=rate, budget=20))
    assert found.method == method
    assert (found.evidence.proved_rate(STABLE) >= Fraction("0.3")) == (asked == "0.3")


@st.composite
def merging_families(draw):
    """Discrete time: few different blocks, coupled in some modes, and some modes twice."""
    entry = st.integers(-3, 3).map(lambda n: Fraction(n, 4))
    blocks = []
    for size in draw(st.lists(st.integers(1, 2), min_size=1, max_size=2)):
        square = st.lists(
            st.lists(entry, min_size=size, max_size=size), min_size=size, max_size=size
        )
        blocks.append(draw(st.lists(square, min_size=1, max_size=2)))
    modes = []
    for _ in range(draw(st.integers(1, 3))):
        modes.append(_stacked([draw(st.sampled_from(block)) for block in blocks], draw(entry)))
    repeated = draw(st.lists(st.sampled_from(modes), max_size=2))
    return family(*modes, *repeated, time=Time.DISCRETE)


def _stacked(blocks, coupling):
    """Put blocks on the diagonal, with one number everywhere above them."""
    order, rows = sum(map(len, blocks)), []
    for block in blocks:
        before, n = len(rows), len(block)
        right = [coupling] * (order - before - n)
        rows += [[*[0] * before, *row, *right] for row in block]
    return rows


ANY_RATE = Limits(optimize_rate=False)
# What every result must say of itself, whatever it is.
SHOWN = {Shows.STABILITY: Verdict.PROVED, Shows.INSTABILITY: Verdict.REFUTED}


def settle(system, method=Method.AUTO, limits=None):
    """Certify, and hold every statement against its definition."""
    result = certify(system, method, limits)
    assert all(holds(system, statement) for statement in result.statements)
    shown = {statement.shows for statement in result.statements}
    assert not {Shows.STABILITY, Shows.INSTABILITY} <= shown
    verdicts = [SHOWN[kind] for kind in shown if kind in SHOWN]
    assert result.verdict is (verdicts[0] if verdicts else Verdict.INCONCLUSIVE)
    assert (result.evidence is None) == (result.verdict is Verdict.INCONCLUSIVE)
    if result.common_quadratic is CommonQuadraticStatus.EXISTS:
        assert result.verdict is Verdict.PROVED
        assert Shows.NO_COMMON_QUADRATIC not in shown
    if result.verdict is Verdict.REFUTED:
        assert result.common_quadratic is CommonQuadraticStatus.IMPOSSIBLE
    if shape_of(result.evidence) == "common-quadratic":
        assert result.common_quadratic is CommonQuadraticStatus.EXISTS
    return result


def outcome(system, method=Method.AUTO, limits=None):
    """Return the verdict, and whether a common quadratic function exists."""
    result = settle(system, method, limits)
    return str(result.verdict), str(result.common_quadratic)


def bad_mode(evidence):
    """Return the name of the mode that refutes, maybe by one of its blocks."""
    if isinstance(evidence, BlockTriangular):
        ((_, evidence),) = evidence.parts
    return evidence.steps[0][0]


class TestNearTheThreshold:
    """Dayawansa and Martin 1999: quadratic iff a < 3 + 2 sqrt(2) = 5.82842712474619..."""

    @pytest.mark.parametrize("a", ["1", "3", "5", "5.8", "5.82", "5.828", "5.8284"])
    def test_proved_below(self, a):
        assert outcome(dayawansa_martin(a), limits=ANY_RATE) == ("proved", "exists")

    @pytest.mark.slow
    @pytest.mark.parametrize("a", ["5.8285", "10"])
    def test_no_quadratic_function_above(self, a):
        assert outcome(dayawansa_martin(a)) == ("proved", "impossible")
        for method in (Method.LMI, Method.GRADIENT):
            assert outcome(dayawansa_martin(a), method) == ("inconclusive", "unknown")

    @pytest.mark.parametrize("a", ["11.262", "12", "100"])
    def test_refuted_beyond_the_limit_of_stability(self, a):
        """Stable iff a < 11.2608..."""
        assert outcome(dayawansa_martin(a)) == ("refuted", "impossible")

    @pytest.mark.parametrize("a", ["11", "11.26"])
    def test_never_wrong_just_below_it(self, a):
        limits = Limits(max_degree=12)
        assert settle(dayawansa_martin(a), limits=limits).verdict is not Verdict.REFUTED


class TestModes:
    @pytest.mark.parametrize(
        "A", [ROTATION, SINGULAR, [[0, 0], [0, 0]], [[0, 1], [0, 0]], [[1, 0], [0, -1]]]
    )
    @pytest.mark.parametrize("others", [0, 1, 3])
    def test_one_bad_mode_refutes(self, A, others):
        result = settle(family(*[[[-1, 0], [0, -1]]] * others, A))
        assert result.verdict is Verdict.REFUTED
        assert bad_mode(result.evidence) == f"m{others}"

    @by_rows("A")
    def test_one_bad_mode_refutes_in_discrete_time(self, A):
        result = settle(family([[0, 0], [0, 0]], A, time=Time.DISCRETE))
        assert result.verdict is Verdict.REFUTED

    @pytest.mark.parametrize("digits", [6, 9, 15, 30, 90])
    def test_barely_stable_and_barely_unstable(self, digits):
        tiny = Fraction(1, 10**digits)
        barely = settle(family([[-tiny, 1], [-1, -tiny]]))
        assert barely.verdict is not Verdict.REFUTED
        assert settle(family([[tiny, 1], [-1, tiny]])).verdict is Verdict.REFUTED
        assert settle(family([[1 + tiny]], time=Time.DISCRETE)).verdict is Verdict.REFUTED
        assert settle(family([[1 - tiny]], time=Time.DISCRETE)).verdict is not Verdict.REFUTED

    @pytest.mark.parametrize("optimize_rate", [True, False])
    @pytest.mark.parametrize("A", [[[0, 0], [0, 0]], [[0, 1], [0, 0]], [["1/2", 5], [0, "-1/2"]]])
    def test_dead_beat_and_defective_modes(self, A, optimize_rate):
        result = settle(family(A, time=Time.DISCRETE), limits=Limits(optimize_rate=optimize_rate))
        assert result.verdict is Verdict.PROVED

    @pytest.mark.parametrize("sign", [1, -1])
    @pytest.mark.parametrize("digits", [3, 17, 21, 300, 1900])
    def test_one_state_nearer_to_the_limit_than_floats_are(self, digits, sign):
        """Decided exactly, alone and with others; so are the blocks of larger modes."""
        tiny = Fraction(1, 10**digits)
        below, above = sign * (1 - tiny), sign * (1 + tiny)
        for near, verdict in ((below, Verdict.PROVED), (above, Verdict.REFUTED)):
            assert settle(family([[near]], time=Time.DISCRETE)).verdict is verdict
            assert settle(family([[near]], [[-near]], time=Time.DISCRETE)).verdict is verdict
            coupled = [[near, 1], [0, -near]]
            assert settle(family(coupled, time=Time.DISCRETE)).verdict is verdict
        assert settle(family([[-tiny]], [[-1]])).verdict is Verdict.PROVED
        assert settle(family([[tiny]], [[-1]])).verdict is Verdict.REFUTED

    def test_many_modes(self):
        """300 modes around -I, more than enter the solver at once."""
        generator = np.random.default_rng(3)
        matrices = [
            [
                [Fraction(int(e), 100) - 2 * (i == j) for j, e in enumerate(row)]
                for i, row in enumerate(A)
            ]
            for A in generator.integers(-40, 40, (300, 5, 5))
        ]
        assert settle(family(*matrices), limits=ANY_RATE).verdict is Verdict.PROVED

    def test_many_modes_with_one_bad_one(self):
        matrices = [[[-1, Fraction(i, 300)], [0, -1]] for i in range(300)]
        matrices[217] = SINGULAR
        assert settle(family(*matrices)).evidence.steps[0][0] == "m217"

    def test_many_states(self):
        A = [[-2 if i == j else int(j == i + 1) for j in range(20)] for i in range(20)]
        B = [list(column) for column in zip(*A, strict=True)]
        assert settle(family(A, B), limits=ANY_RATE).verdict is Verdict.PROVED


class TestScales:
    """In other units of time and of the states, the answer is the same."""

    @pytest.mark.parametrize("scale", ["1e-100", "1e-9", "1e-5", "1e5", "1e9", "1e100", "1e190"])
    def test_unit_of_time(self, scale):
        result = settle(dayawansa_martin(5, Fraction(scale)))
        assert result.verdict is Verdict.PROVED
        assert 0.105 < result.evidence.rate / Fraction(scale) < 0.1056
        above = settle(dayawansa_martin(6, Fraction(scale)))
        assert above.verdict is Verdict.PROVED
        assert above.common_quadratic is CommonQuadraticStatus.IMPOSSIBLE

    @pytest.mark.parametrize("scale", ["1e-100", "1e-5", "1e5", "1e100"])
    def test_units_of_the_states(self, scale):
        s = Fraction(scale)
        pair = [[[-1, -s], [1 / s, -1]], [[-1, -5 * s], [1 / (5 * s), -1]]]
        assert settle(family(*pair)).verdict is Verdict.PROVED

    @pytest.mark.parametrize(
        "scale", ["1e-190", *map(slow, ("1e-100", "1e-5", "1e5", "1e100")), "1e190"]
    )
    @pytest.mark.parametrize("time", list(Time))
    def test_nothing_crashes(self, scale, time):
        s = Fraction(scale)
        for matrices in (
            [[[-1, s], [0, -1]], [[-1, 0], [1 / s, -1]]],
            [[[-1, s], [0, -1]], [[-1 / s, 0], [1, -1]]],
            [[[-s, 0], [0, -1 / s]]],
            [[[Fraction(1, 2), s], [0, Fraction(1, 2)]]],
            [[[Fraction(1, 2), s], [s, Fraction(1, 2)]]],
            [[[0, s], [0, 0]], [[0, 0], [s, 0]]],
        ):
            settle(family(*matrices, time=time), limits=replace(ANY_RATE, max_degree=4))

    def test_beyond_floating_point(self):
        huge = 10**400
        mixed = settle(family([[-huge, 1], [1, -1]]), limits=Limits(max_degree=4))
        assert mixed.verdict is Verdict.INCONCLUSIVE
        assert settle(family([[huge, 1], [1, -1]])).verdict is Verdict.REFUTED
        assert settle(family([[-huge, 0], [0, -1]])).verdict is Verdict.PROVED
        assert certify(family([[huge, 0], [0, -1]])).verdict is Verdict.REFUTED


class TestMethods:
    def test_steps_are_told_and_timed(self):
        told = []
        result = certify(dayawansa_martin(12), progress=told.append)
        assert told == [
            "suspicious modes",
            "lmi",
            "obstruction",
            "every mode",
            "mixture",
            "polynomial of degree 4",
            "polynomial of degree 6",
            "period",
        ]
        assert [attempt.step for attempt in result.attempts] == told
        assert all(attempt.seconds >= 0 for attempt in result.attempts)

    @pytest.mark.parametrize(
        ("method", "system", "expected"),
        [
            (Method.LMI, STABLE, ("proved", "exists")),
            pytest.param(Method.GRADIENT, STABLE, ("proved", "exists"), marks=pytest.mark.slow),
            (Method.OBSTRUCTION, STABLE, ("inconclusive", "unknown")),
            (Method.OBSTRUCTION, NOT_QUADRATIC, ("inconclusive", "impossible")),
            (Method.POLYNOMIAL, NOT_QUADRATIC, ("proved", "unknown")),
            (Method.PERIOD, NOT_QUADRATIC, ("inconclusive", "unknown")),
            (Method.PERIOD, dayawansa_martin(12), ("refuted", "impossible")),
            (Method.MIXTURE, dayawansa_martin(12), ("inconclusive", "unknown")),
            (Method.MIXTURE, SHEARS, ("refuted", "impossible")),
            (Method.MODE_QUADRATIC, SLOW, ("proved", "unknown")),
            (Method.CONSTANTS_QUADRATIC, CONSTANT, ("proved", "unknown")),
            (Method.VALUE, CONSTANT, ("inconclusive", "unknown")),
            (Method.AUTO, SLOW, ("proved", "impossible")),
            (Method.AUTO, CONSTANT, ("proved", "impossible")),
        ],
    )
    def test_every_rung_alone(self, method, system, expected):
        assert outcome(system, method) == expected

    @pytest.mark.parametrize(
        "method",
        sorted(
            set(Method)
            - {Method.MODE_POLYNOMIAL, Method.PERIODIC_QUADRATIC}
            - {method for method in Method if method.startswith(("conewise", "memory"))}
        ),
    )
    def test_an_unstable_mode_is_found_whatever_was_asked_for(self, method):
        bad = replace(
            UNSTABLE,
            switching=CONSTANT.switching
            if method in (Method.CONSTANTS_QUADRATIC, Method.VALUE)
            else UNSTABLE.switching,
        )
        assert outcome(bad, method) == ("refuted", "impossible")

    @by_rows("method", "system", method=Method, system=globals().get)
    def test_rungs_that_do_not_apply_are_refused(self, method, system):
        with pytest.raises(DesignError, match=f"{method} does not apply") as caught:
            certify(system, method)
        assert caught.value.remedy == "use --method auto"

    def test_highest_degree(self):
        """a = 10 needs degree 8."""
        result = settle(dayawansa_martin(10), limits=Limits(max_degree=6))
        assert (result.verdict, result.common_quadratic) == ("inconclusive", "impossible")
        last = result.attempts[-1]
        assert (last.step, last.outcome) == (
            "polynomial of degree 8",
            "not tried: --max-degree is 6",
        )
        assert settle(dayawansa_martin(10), limits=Limits(max_degree=8)).evidence.degree == 4

    @pytest.mark.slow
    def test_blocks_share_the_budget(self):
        """What one block cannot use up is left for the other, which refutes."""
        hard = dayawansa_martin("11.26").modes
        grows = dayawansa_martin(12).modes
        pair = [
            [[*row, 0, 0] for row in A.A.fractions()] + [[0, 0, *row] for row in B.A.fractions()]
            for A, B in zip(hard, grows, strict=True)
        ]
        found = settle(family(*pair), limits=Limits(budget=4.0, optimize_rate=False))
        assert found.verdict is Verdict.REFUTED

    def test_steps_beyond_the_memory_are_not_tried(self):
        found = settle(dayawansa_martin(10), limits=Limits(memory=10_000.0))
        assert found.verdict is Verdict.INCONCLUSIVE
        assert any("(--memory)" in attempt.outcome for attempt in found.attempts)

    def test_no_rung_is_begun_when_the_budget_is_used_up(self):
        result = settle(dayawansa_martin(10), limits=Limits(budget=0.0))
        assert result.verdict is Verdict.INCONCLUSIVE
        assert "budget" in result.attempts[-1].outcome
        assert len(result.attempts) < 3

    @pytest.mark.parametrize("budget", [0.05, 0.2])
    def test_no_clock_changes_what_a_budget_that_cuts_the_search_short_finds(
        self, monkeypatch, budget
    ):
        """It stalls, crawls or races: counts, verdict and every number are those of the others."""
        system, limits = dayawansa_martin("10.6"), Limits(budget=budget)
        found = []
        for pace in (0.0, 1e-6, 1e-3):
            ticks = count()
            monkeypatch.setattr(
                "nrs_design.search.work.monotonic",
                lambda pace=pace, ticks=ticks: pace * next(ticks),
            )
            result = certify(system, limits=limits)
            counts = [(a.step, a.outcome, a.work) for a in result.attempts]
            found.append((result.verdict, result.statements, counts))
        assert found[0] == found[1] == found[2]
        assert result.statements != certify(system).statements

    def test_a_search_that_the_clock_stops_decides_nothing(self, monkeypatch):
        """Not even where a proof was at hand already, at a rate that more time would raise."""
        jump = iter([*[0.0] * 30, *[1e9] * 10**6])
        monkeypatch.setattr("nrs_design.search.work.monotonic", lambda: next(jump))
        with pytest.raises(ClockError, match="the clock stopped this after 660 s"):
            certify(STABLE)

    def test_equal_modes_and_blocks_change_nothing(self):
        """Two copies of each mode, beside a state that decays by itself."""
        blocks = [
            [[*row, 0] for row in mode.A.fractions()] + [[0, 0, -1]] for mode in NOT_QUADRATIC.modes
        ]
        assert outcome(family(*blocks, *blocks)) == ("proved", "impossible")
        assert outcome(family(*blocks, *blocks, UNSTABLE_BLOCK)) == ("refuted", "impossible")

    @pytest.mark.parametrize("c", ["0.72", "0.99"])
    def test_equal_modes_in_discrete_time(self, c):
        """Proved by a function for each mode, or by polynomials: both repeat what equals share."""
        assert outcome(family(*ando_shih(c), ando_shih(c)[1], time=Time.DISCRETE))[0] == "proved"

    @pytest.mark.parametrize("method", [Method.AUTO, Method.POLYNOMIAL, Method.MODE_QUADRATIC])
    def test_a_parameter_that_does_not_reach_the_diagonal(self, method):
        """Two corners with the same two blocks: every statement about a block is for both."""
        modes = [
            [[*row, coupling, 0] for row in top] + [[0, 0, *row] for row in bottom]
            for coupling in (1, 2)
            for top, bottom in product(ando_shih("0.72"), repeat=2)
        ]
        system = family(*modes, time=Time.DISCRETE)
        limits = Limits(max_degree=4, optimize_rate=False)
        assert settle(system, method, limits).verdict is Verdict.PROVED

    @given(merging_families(), st.sampled_from([Method.AUTO, *DISCRETE_METHODS]))
    def test_merged_modes_and_blocks_always_end_in_a_verdict(self, system, method):
        """Whatever a search returns holds for all modes, equal ones and those of blocks too."""
        settle(system, method, Limits(max_degree=4, budget=1.0, optimize_rate=False))

    def test_rate_limit_is_never_beaten(self):
        for system in (STABLE, NOT_QUADRATIC, DISCRETE):
            result = settle(system)
            rate = result.evidence.proved_rate(system)
            better = rate <= result.rate_limit
            assert better if system.time is Time.CONTINUOUS else rate >= result.rate_limit


LIES = {
    "indefinite": lambda n: np.diag([1.0] + [-1.0] * (n - 1)),
    "negative": lambda n: -np.eye(n),
    "zero": lambda n: np.zeros((n, n)),
    "identity": np.eye,
    "singular": lambda n: np.ones((n, n)),
    "skew": lambda n: np.triu(np.ones((n, n))) - np.tril(np.ones((n, n)), -1),
    "lopsided": lambda n: np.eye(n) + np.triu(np.full((n, n), 1e9), 1),
    "nan": lambda n: np.full((n, n), np.nan),
    "one nan": lambda n: np.where(np.eye(n) > 0, 1.0, np.nan),
    "inf": lambda n: np.full((n, n), np.inf),
    "mixed inf": lambda n: np.diag([np.inf] + [1.0] * (n - 1)),
    "huge": lambda n: 1.5e308 * np.eye(n),
    "tiny": lambda n: 5e-324 * np.eye(n),
    "stretched": lambda n: np.diag(10.0 ** np.linspace(-300, 300, n)),
    "slightly wrong": lambda n: np.eye(n) - 1e-9 * np.ones((n, n)),
}
SYSTEMS = {
    "stable": (STABLE, {Verdict.PROVED, Verdict.INCONCLUSIVE}),
    "not quadratic": (NOT_QUADRATIC, {Verdict.PROVED, Verdict.INCONCLUSIVE}),
    "grows": (dayawansa_martin(12), {Verdict.REFUTED}),
    "marginal": (MARGINAL, {Verdict.REFUTED}),
    "unstable": (UNSTABLE, {Verdict.REFUTED}),
    "antistable": (family([[1, 0], [0, 1]]), {Verdict.REFUTED}),
    "saddle": (family([[-1, 0], [0, 1]]), {Verdict.REFUTED}),
    "stable discrete": (
        family([["1/2", 0], [1, "1/2"]], time=Time.DISCRETE),
        {Verdict.PROVED, Verdict.INCONCLUSIVE},
    ),
    "unstable discrete": (family([[2, 0], [0, 2]], time=Time.DISCRETE), {Verdict.REFUTED}),
}


def solving(lie):
    """Return what a program solves if every form of it is a lie."""

    def solve(program, *_):
        forms = [lie(n) for n in program.sizes]
        vanishing = [np.zeros((edge.size, edge.size)) for edge in program.edges]
        return Solution(forms, np.zeros(len(program.scales)), vanishing)

    return solve


# What no lie may prove, in both kinds of time.
TWO = ("marginal", "unstable discrete")
ASKED = (Limits(max_degree=4), replace(ANY_RATE, max_degree=4))


def wrong_lies(name, tell, *, asked=ASKED, may_give_up=False):
    """Tell every lie, and return those that ended in a verdict that is not one of this system."""
    system, allowed = SYSTEMS[name]
    allowed = allowed | ({Verdict.INCONCLUSIVE} if may_give_up else set())
    wrong = {}
    for lie, answer in LIES.items():
        tell(answer)
        for limits in asked:
            try:
                verdict = settle(system, limits=limits).verdict
            except AssertionError as false:
                wrong[lie] = false
            else:
                if verdict not in allowed:
                    wrong[lie] = verdict
    return wrong


@pytest.mark.parametrize("name", [name if name in TWO else slow(name) for name in SYSTEMS])
class TestLyingSolvers:
    """Whatever the search returns, and even if no mode is tested before it."""

    @pytest.fixture(autouse=True)
    def _only_the_lie(self, monkeypatch):
        monkeypatch.setattr(
            unstable_mode, "seems_stable", lambda family: np.ones(len(family.matrices), bool)
        )
        monkeypatch.setattr(gradient, "iterate_gradient", lambda *_: GradientResult(None, 0))

    def test_the_search(self, monkeypatch, name):
        def tell(lie):
            monkeypatch.setattr(FormsProgram, "solve", solving(lie))

        assert not wrong_lies(name, tell)

    def test_the_gradient(self, monkeypatch, name):
        def tell(lie):
            monkeypatch.setattr(
                gradient,
                "iterate_gradient",
                lambda matrices, *_: GradientResult(lie(matrices.shape[1]), 1),
            )

        monkeypatch.setattr(FormsProgram, "solve", lambda *_: None)
        assert not wrong_lies(name, tell)

    def test_every_semidefinite_program(self, monkeypatch, name):
        """The same lie wherever the solver is called, and only there."""

        def tell(lie):
            def answer(program, allowance):
                x = np.resize(lie(2).ravel(), program.unknowns)
                return Maximum(x, []) if np.isfinite(x).all() else None

            monkeypatch.setattr(SemidefiniteProgram, "maximize", answer)

        # Rates are claimed for what is found, and here is nothing.
        assert not wrong_lies(name, tell, asked=ASKED[1:], may_give_up=True)


def test_slightly_wrong_answers_do_not_pass(monkeypatch):
    """A Q for a = 5.82 is not one for a = 5.9, however near."""
    below = certify(dayawansa_martin("5.82"), limits=ANY_RATE).evidence
    Q = np.array(below.nodes[0].form, dtype=float)
    with monkeypatch.context() as lying:
        lying.setattr(FormsProgram, "solve", solving(lambda n: Q))
        assert settle(dayawansa_martin("5.9"), Method.LMI).verdict is Verdict.INCONCLUSIVE
    assert outcome(dayawansa_martin("5.9")) == ("proved", "impossible")


def test_a_wrong_check_is_stopped(monkeypatch):
    """If the trusted check accepted anything, flint would still stop a wrong proof."""
    monkeypatch.setattr(FormsOnGraph, "find_fault", lambda *_: None)
    monkeypatch.setattr(FormsProgram, "solve", solving(np.eye))
    monkeypatch.setattr(FormsProgram, "own_rate", lambda *_: 0.5)
    with pytest.raises(InternalError):
        certify(NOT_QUADRATIC, limits=ANY_RATE)


GOOD = common_quadratic(((1, 0), (0, 1)), 0, Fraction(1, 2))
WRONG = replace(GOOD, rate=Fraction(2))
ROUND = family([[-1, 1], [-1, -2]], [[-2, 1], [-1, -1]])


class TestFirstAccepted:
    """The one place where candidates become evidence."""

    def take(self, candidates, ended=None):
        asked = []

        def search():
            for candidate in candidates:
                asked.append(candidate)
                yield Candidate(candidate, "as proposed")
            return ended

        return first_accepted(search(), ROUND), asked

    def test_the_first_that_holds_is_taken_and_no_more_are_asked_for(self):
        taken, asked = self.take([WRONG, GOOD, replace(GOOD, rate=Fraction(1, 4))])
        assert taken == (GOOD, "as proposed")
        assert taken[0] is GOOD
        assert asked == [WRONG, GOOD]

    def test_each_candidate_is_checked_once(self, monkeypatch):
        calls = []
        find_unfit = FormsOnGraph.find_unfit
        monkeypatch.setattr(
            FormsOnGraph, "find_unfit", lambda self, s: calls.append(self) or find_unfit(self, s)
        )
        monkeypatch.setattr(ladder, "LADDER", one_rung([WRONG, GOOD]))
        assert certify(ROUND).evidence is GOOD
        assert calls == [WRONG, GOOD]

    def test_the_search_says_why_there_is_none(self):
        assert self.take([], "nothing looked right") == ((None, "nothing looked right"), [])
        assert self.take([WRONG], "all looked wrong")[0] == (None, "all looked wrong")

    def test_a_search_without_words_and_candidates_had_no_rate_to_claim(self):
        assert self.take([])[0] == (None, "what was found shows no rate of decay")

    def test_or_the_check_says_why_the_last_was_refused(self):
        (nothing, words), _ = self.take([WRONG])
        assert nothing is None
        assert words.startswith("a candidate was found, but V does not decrease")


def one_rung(lies):
    """A ladder with one rung, which proposes what it is told to."""

    def search(family):
        yield from (Candidate(lie, "trust me") for lie in lies)
        return None

    return (ladder.Rung("lies", Method.LMI, lambda facts: True, search),)


@pytest.mark.parametrize("lie", [WRONG, common_quadratic(((1, 0), (0, -1)), 0, Fraction(1, 2))])
@pytest.mark.parametrize("twice", [False, True])
def test_a_search_that_lies_proves_nothing(monkeypatch, lie, twice):
    monkeypatch.setattr(ladder, "LADDER", one_rung([lie]))
    system = replace(ROUND, modes=(*ROUND.modes, replace(ROUND.modes[0], name="again")))
    found = certify(system if twice else ROUND)
    assert (found.verdict, found.statements) == (Verdict.INCONCLUSIVE, ())
    (attempt,) = found.attempts
    assert attempt.outcome.startswith("a candidate was found, but ")


def test_evidence_that_does_not_hold_for_all_modes_is_found_out(monkeypatch):
    """Merged modes get what holds for them; what is made of it for all modes is checked again."""
    twice = replace(ROUND, modes=(*ROUND.modes, replace(ROUND.modes[0], name="again")))
    monkeypatch.setattr(FormsOnGraph, "spread", lambda self, merged, system: WRONG)
    assert certify(ROUND, Method.LMI).verdict is Verdict.PROVED
    with pytest.raises(InternalError, match="does not hold"):
        certify(twice, Method.LMI)


@by_rows("module")
def test_nouns_are_imported_without_numpy(module):
    code = f"import sys, nrs_design.{module}; print('numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\n"


def test_the_deciding_statement_is_the_evidence():
    proved = certify(dayawansa_martin(5), Method.LMI, Limits(optimize_rate=False))
    assert proved.evidence is proved.statements[0]
    nothing = certify(dayawansa_martin(6), Method.LMI, Limits(optimize_rate=False))
    assert (nothing.evidence, nothing.statements) == (None, ())
