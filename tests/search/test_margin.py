"""How far proofs reach: brackets that must be true, on every axis."""

from dataclasses import replace
from fractions import Fraction
from functools import partial

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.certificates.certificate import CommonQuadraticStatus, Verdict
from nrs_design.errors import AssemblyError, DesignError
from nrs_design.pipeline.margins import run_proof_margins
from nrs_design.pipeline.runs import run_certification
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search import margin
from nrs_design.search.certification import Certification, Limits
from nrs_design.search.certify import certify
from nrs_design.search.method import Method
from nrs_design.spec import read_spec
from nrs_design.spec.switching import LONGEST_DWELL
from tests.proof.evidence.test_invariant_ellipsoid import BOUNCE
from tests.proof.systems import bouncing, pushed
from tests.support import ROOT, dayawansa_martin, family, holds
from tests.tables import by_rows

QUICK = Limits(max_degree=6, budget=2.0, optimize_rate=False)
ANY = family([[-1]])
GEROMEL_COLANERI = family([[0, 1], [-10, -1]], [[0, 1], ["-0.1", "-0.5"]])
P, R, N = Verdict.PROVED, Verdict.REFUTED, Verdict.INCONCLUSIVE
quick = partial(certify, limits=QUICK)


def oscillator(stretch):
    """x'' + x' + (2 + k) x = 0 with k in [0, 3 stretch]: stable iff 3 stretch < 6.98513."""
    return family([[0, 1], [-2, -1]], [[0, 1], [-2 - 3 * stretch, -1]])


def certified(verdict, system=ANY):
    return Certification(system, verdict, CommonQuadraticStatus.UNKNOWN, "rule", (), ())


class Rule:
    """Verdicts by a rule for the number, which may say why it makes no system."""

    def __init__(self, rule):
        self.rule, self.seen = rule, []

    def assemble(self, number):
        if not isinstance(fault := self.rule(number), Verdict):
            raise AssemblyError(fault)
        return replace(ANY, name=str(number))

    def certify(self, system):
        self.seen.append(Fraction(system.name))
        return certified(self.rule(self.seen[-1]), system)


def between(proved, refuted, beyond=10**9):
    """Proved up to a number, refuted from another one on; no system beyond a last one."""

    def rule(number):
        if number > beyond:
            return "too large"
        return P if number <= proved else R if number >= refuted else N

    return rule


def ruled(numbers):
    return between(*map(Fraction, numbers))


def box_of(rule, known=None):
    given_rule = Rule(rule)
    found = margin.find_margin(given_rule.assemble, given_rule.certify, known)
    assert len(set(given_rule.seen)) == len(given_rule.seen)
    return found, given_rule.seen


@pytest.mark.slow
def test_published_limit_of_the_oscillator():
    """Zelentsovsky 1994: 6.98513; by quadratic functions alone 1 + 2 sqrt(2)."""
    box = margin.find_margin(oscillator, quick)
    assert 6 < 3 * box.proved < 6.98513 < 3 * box.refuted < 7
    assert box.proof.system == oscillator(box.proved)
    assert all(holds(box.proof.system, item) for item in box.proof.statements)


def test_quadratic_functions_alone_reach_the_circle_criterion():
    box = margin.find_margin(oscillator, lambda system: certify(system, Method.LMI, QUICK))
    assert 3.8 < 3 * box.proved < 1 + 2 * 2**0.5
    assert box.refuted is None


@settings(deadline=None)
@given(st.fractions("1/64", 60), st.fractions(0, 5))
def test_a_box_is_true_and_narrow(proved, gap):
    limit = proved + gap + Fraction(1, 10**9)
    box, seen = box_of(between(proved, limit))
    assert 0 <= proved - box.proved <= max(box.proved, 1) * Fraction(1, 2**margin.STEPS)
    # The gap of ignorance is found from both sides, unless it is too wide.
    assert box.refuted is not None or limit > min(8 * max(proved, 1), 64)
    if box.refuted is not None:
        assert 0 <= box.refuted - limit <= box.refuted * Fraction(1, 2**margin.REFUTED_STEPS)
    assert {box.proved, box.refuted} - {None} <= {*seen}


@pytest.mark.parametrize("known", list(Verdict))
def test_a_box_never_contradicts_what_is_known_of_the_declared_ranges(known):
    """A longer search has settled what the quick one does not find."""
    box, seen = box_of(lambda scale: N, certified(known))
    assert box.proved == (1 if known is P else None)
    assert 1 not in seen


@by_rows("rule", "proved", "refuted", "end", rule=ruled, proved=Fraction, refuted=Fraction)
def test_where_a_box_ends(rule, proved, refuted, end):
    box, _ = box_of(rule)
    assert (box.proved, box.refuted) == (proved, refuted)
    assert end in box.end
    assert bool(box.end) == (refuted is None)


def test_nominal_values_that_make_no_system_are_an_error():
    with pytest.raises(AssemblyError, match="too large"):
        box_of(between(1, 2, beyond=-1))


@by_rows("rule", "shortest", "declared", "unstable", "expected", rule=ruled, expected=tuple)
def test_the_longest_delay(rule, shortest, declared, unstable, expected):
    """Beyond ten samples, those from `unstable` on are refuted by a quick test alone."""
    own, told = Rule(rule), []

    def assemble(first, last):
        return own.assemble(last) if first == shortest else replace(ANY, name=str(last))

    def unstable_in(system):
        return "in kept contact" if int(system.name) >= unstable else None

    known = certified(rule(declared))
    found = margin.find_longest_delay(
        (shortest, declared, 10), assemble, own.certify, unstable_in, known, told.append
    )
    assert (found.proved, found.refuted) == expected
    assert ("up to 32" in found.end) == (found.refuted is None)
    assert found.refuted_in == ("in kept contact" if found.refuted == unstable else "")
    assert declared not in own.seen
    assert len(set(own.seen)) == len(own.seen) <= 8
    if own.seen and own.seen[0] > declared and rule(declared) is P:
        assert told[0] == f"delay {own.seen[0]} (proved: {declared})"


def period_of(start, rule):
    own = Rule(rule)
    known = certified(rule(start))
    return margin.find_longest_period(Fraction(start), own.assemble, own.certify, known)


@pytest.mark.parametrize("start", [1, 4, 8])
def test_the_longest_period(start):
    """Proved up to 3, refuted from 5 on; in between nobody knows."""
    found = period_of(start, between(3, 5))
    assert Fraction(5, 2) < found.proved <= 3
    assert 5 <= found.refuted < Fraction(55, 10)


def test_where_no_period_is_refuted_the_end_is_named():
    found = period_of(1, between(1, 9, beyond=1))
    assert (found.proved, found.refuted) == (1, None)
    assert found.end == "none of up to 1 s is refuted: what is beyond makes no system (too large)"
    nothing = period_of(1, lambda period: N)
    assert nothing == margin.Bracket(
        None, None, "none of up to 16 s is refuted: the search ends there"
    )


def dwell_of(system, rule, known=None):
    """Find the shortest dwell time where a rule says what is proved of one."""
    asked = []

    def decide(changed):
        asked.append(changed.switching.dwell_time)
        return certified(rule(asked[-1]), changed)

    found = margin.find_shortest_dwell(system, decide, certified(known or N, system))
    assert len(set(asked)) == len(asked)
    return found, asked


@pytest.mark.slow
@pytest.mark.parametrize(
    ("system", "low", "high"),
    [
        # Geromel and Colaneri 2006: proofs above 2.75084 s, refuted up to 2.70775 s.
        (GEROMEL_COLANERI, (2.7, 2.70776), (2.75084, 2.7525)),
        # Far beyond 64 times the modes' fastest time.
        (
            family([["-0.01", 1], [-1, "-0.01"]], [["-0.01", 10], ["-0.1", "-0.01"]]),
            (100, 1e9),
            (100, 1e9),
        ),
    ],
)
def test_shortest_dwell_times_that_are_known(system, low, high):
    dwell = margin.find_shortest_dwell(system, quick, quick(system))
    assert low[0] < dwell.refuted < low[1]
    assert high[0] < dwell.proved < high[1]
    assert dwell.proved < 1.02 * dwell.refuted
    assert dwell.proof.system.switching.dwell_time == dwell.proved
    assert all(holds(dwell.proof.system, item) for item in dwell.proof.statements)


def test_no_dwell_time_is_needed():
    system = dayawansa_martin(5)
    dwell = margin.find_shortest_dwell(system, quick, quick(system))
    assert (dwell.proved, dwell.refuted, dwell.proof.verdict) == (0, None, "proved")


@pytest.mark.parametrize("other", [[[-1]], [[2]]])
def test_no_dwell_time_is_long_enough_for_an_unstable_mode(other):
    system = family([[1]], other)
    dwell = margin.find_shortest_dwell(system, quick, quick(system))
    assert dwell == margin.Bracket(None, LONGEST_DWELL)


@settings(deadline=None)
@given(st.fractions("1/100", 4000), st.fractions(0, 1), st.fractions(0, 4096))
def test_a_dwell_time_is_true_and_narrow(proved, share, own):
    refuted = proved * share * Fraction(99, 100)

    def rule(time):
        return P if time >= proved else R if time <= refuted else N

    dwell, asked = dwell_of(replace(ANY, switching=Switching(own)), rule, rule(own))
    size = max(proved, 1)
    assert 0 <= refuted - dwell.refuted <= 2 * size * Fraction(1, 2**margin.REFUTED_STEPS)
    assert 0 <= dwell.proved - proved <= 2 * size * Fraction(1, 2**margin.DWELL_STEPS)
    assert {dwell.proved, dwell.refuted} <= {*asked, own}


@pytest.mark.parametrize(("verdict", "proved", "refuted"), [(P, 3, None), (R, None, 0), (N,) * 3])
def test_what_is_known_of_dwell_times_of_their_own(verdict, proved, refuted):
    """Proved for 3 s in one mode and none in the other: that says nothing of 0 s in both."""
    a, b = (mode.name for mode in GEROMEL_COLANERI.modes)
    own = ((a, Stay(Fraction(3))), (b, Stay()))
    system = replace(GEROMEL_COLANERI, switching=Switching(stays=own))
    dwell, asked = dwell_of(system, lambda time: N, verdict)
    expected = (None, None) if verdict is N else (proved, refuted)
    assert (dwell.proved, dwell.refuted) == expected
    assert max(asked) == LONGEST_DWELL or proved


@by_rows("name", "said")
def test_no_dwell_time_for_ranges_and_discrete_time(name, said):
    path = ROOT / "specs" / "examples" / f"{name}.nrs.yaml"
    result = run_certification(read_spec(path), limits=QUICK)
    with pytest.raises(DesignError, match=said):
        run_proof_margins(result, QUICK, margin=False, shortest_dwell=True)


def test_disturbances_that_keep_the_limit():
    """The limit is 1 N, the level 3/5 N, and a run reaches 1/2 N: by proportion."""
    bound = BOUNCE.bound(pushed(bouncing()))
    found = margin.command_margin(bound, 0.5)
    assert found.limit == 1
    assert found.bounds["push"] == (Fraction(1, 4) * Fraction(5, 3), Fraction(1, 2), "N")
    assert margin.command_margin(bound, 0.0) is None
