"""The largest box and the shortest dwell time with a proof: brackets that must be true."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.certificates.certificate import CommonQuadraticStatus, Verdict
from nrs_design.errors import AssemblyError, DesignError
from nrs_design.pipeline.margins import run_proof_margins
from nrs_design.pipeline.runs import run_certification
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.certification import Certification, Limits
from nrs_design.search.certify import certify
from nrs_design.search.margin import (
    DOUBLINGS,
    DWELL_STEPS,
    LARGEST_SCALE,
    REFUTED_STEPS,
    STEPS,
    DwellMargin,
    find_margin,
    find_shortest_dwell,
)
from nrs_design.search.method import Method
from nrs_design.spec import read_spec
from nrs_design.spec.switching import LONGEST_DWELL
from tests.support import ROOT, dayawansa_martin, family, holds

EXAMPLES = ROOT / "specs" / "examples"
QUICK = Limits(max_degree=6, budget=2.0, optimize_rate=False)
ANY = family([[-1]])
GEROMEL_COLANERI = family([[0, 1], [-10, -1]], [[0, 1], ["-0.1", "-0.5"]])


def oscillator(stretch):
    """x'' + x' + (2 + k) x = 0 with k in [0, 3 stretch]: stable iff 3 stretch < 6.98513."""
    return family([[0, 1], [-2, -1]], [[0, 1], [-2 - 3 * stretch, -1]])


def quick(system):
    return certify(system, limits=QUICK)


def deciding_by(rule):
    """Make a search and a certifier of which only the verdicts matter."""
    seen = []

    def assemble(stretch):
        seen.append(stretch)
        return replace(ANY, name=str(stretch))

    def decide(system):
        verdict = rule(Fraction(system.name))
        return Certification(system, verdict, CommonQuadraticStatus.UNKNOWN, "rule", (), ())

    return assemble, decide, seen


def verdict_at(system, rule):
    """Certify by a rule for the dwell time."""
    verdict = rule(system.switching.dwell_time)
    return Certification(system, verdict, CommonQuadraticStatus.UNKNOWN, "rule", (), ())


def undecided(system):
    return verdict_at(system, lambda time: Verdict.INCONCLUSIVE)


def bracket_rule(proved, refuted):
    """Dwell times from one on are proved, up to another one refuted."""

    def rule(time):
        if time >= proved:
            return Verdict.PROVED
        return Verdict.REFUTED if time <= refuted else Verdict.INCONCLUSIVE

    return rule


def between(proved, refuted):
    """Verdicts that are monotone, with a gap of ignorance."""

    def rule(stretch):
        if stretch <= proved:
            return Verdict.PROVED
        return Verdict.REFUTED if stretch >= refuted else Verdict.INCONCLUSIVE

    return rule


class TestBox:
    @pytest.mark.slow
    def test_published_limit_of_the_oscillator(self):
        """Zelentsovsky 1994: 6.98513; by quadratic functions alone 1 + 2 sqrt(2)."""
        box = find_margin(oscillator, quick)
        assert 6 < 3 * box.proved < 6.98513 < 3 * box.refuted < 7
        assert box.proof.verdict is Verdict.PROVED
        assert box.proof.system == oscillator(box.proved)
        assert all(holds(box.proof.system, item) for item in box.proof.statements)

    def test_quadratic_functions_alone_reach_the_circle_criterion(self):
        box = find_margin(oscillator, lambda system: certify(system, Method.LMI, QUICK))
        assert 3.8 < 3 * box.proved < 1 + 2 * 2**0.5
        assert box.refuted is None

    @settings(deadline=None)
    @given(st.fractions("1/64", 60), st.fractions(0, 5))
    def test_bracket_is_true_and_narrow(self, proved, gap):
        assemble, decide, seen = deciding_by(between(proved, proved + gap + Fraction(1, 10**9)))
        box = find_margin(assemble, decide)
        assert box.proved <= proved
        assert box.proved in seen
        # The gap of ignorance is found from both sides, unless it is too wide.
        limit = proved + gap + Fraction(1, 10**9)
        assert box.refuted is not None or limit > 2**DOUBLINGS * max(proved, 1)
        if box.refuted is not None:
            assert box.refuted in seen
            assert 0 <= box.refuted - limit <= box.refuted * Fraction(1, 2**REFUTED_STEPS)
        # Doubling brackets by a factor of two, each step then halves.
        assert proved - box.proved <= max(box.proved, 1) * Fraction(1, 2**STEPS)
        assert len(seen) <= STEPS + 9 + DOUBLINGS + REFUTED_STEPS
        assert len(set(seen)) == len(seen)

    def test_not_even_the_nominal_values(self):
        for verdict, refuted in ((Verdict.REFUTED, 0), (Verdict.INCONCLUSIVE, None)):
            assemble, decide, seen = deciding_by(lambda stretch, verdict=verdict: verdict)
            box = find_margin(assemble, decide)
            assert (box.proved, box.refuted, box.proof) == (None, refuted, None)
            # What is not decided is looked at in wider boxes, which may be refuted.
            assert seen == ([0] if refuted == 0 else [0, 1, 2, 4, 8])
            assert bool(box.end) == (refuted is None)

    def test_refuted_beyond_nominal_values_that_are_not_decided(self):
        assemble, decide, _ = deciding_by(
            lambda stretch: Verdict.REFUTED if stretch >= 3 else Verdict.INCONCLUSIVE
        )
        box = find_margin(assemble, decide)
        assert box.proved is None
        assert 3 <= box.refuted < 3.1

    @pytest.mark.parametrize("known", list(Verdict))
    def test_never_contradicts_what_is_known_of_the_declared_ranges(self, known):
        """A longer search has settled what the quick one does not find."""
        assemble, decide, seen = deciding_by(lambda stretch: Verdict.INCONCLUSIVE)
        found = Certification(ANY, known, CommonQuadraticStatus.UNKNOWN, "long", (), ())
        box = find_margin(assemble, decide, found)
        assert box.proved == (1 if known is Verdict.PROVED else None)
        assert 1 not in seen

    def test_no_limit_in_sight(self):
        assemble, decide, seen = deciding_by(lambda stretch: Verdict.PROVED)
        box = find_margin(assemble, decide)
        last = LARGEST_SCALE * 2**DOUBLINGS
        assert (box.proved, box.refuted, max(seen)) == (last, None, last)
        assert box.end == f"none scaled by up to {last} is refuted: the search ends there"

    def test_never_proved_beyond_what_makes_a_system(self):
        """Stiffness below zero, say: neither proved nor refuted."""
        assemble, decide, _ = deciding_by(lambda stretch: Verdict.PROVED)

        def fail_beyond(stretch):
            if stretch > Fraction(5, 4):
                raise AssemblyError("the stiffness is not positive")
            return assemble(stretch)

        box = find_margin(fail_beyond, decide)
        assert (box.proved, box.refuted) == (Fraction(5, 4), None)
        assert "wider ones make no system (the stiffness is not positive)" in box.end

    def test_nominal_values_that_make_no_system_are_an_error(self):
        def fail(stretch):
            raise AssemblyError(f"no stiffness at {stretch}", remedy="use another environment")

        with pytest.raises(AssemblyError, match="no stiffness at 0") as raised:
            find_margin(fail, quick)
        assert raised.value.remedy == "use another environment"

    @pytest.mark.parametrize("verdict", list(Verdict))
    def test_nominal_values_alone_make_a_system(self, verdict):
        assemble, decide, _ = deciding_by(lambda stretch: verdict)

        def fail_beyond(stretch):
            if stretch > 0:
                raise AssemblyError("the stiffness is not positive")
            return assemble(stretch)

        box = find_margin(fail_beyond, decide)
        assert box.proved == (0 if verdict is Verdict.PROVED else None)
        assert box.refuted == (0 if verdict is Verdict.REFUTED else None)
        if box.refuted is None:
            assert "by up to 0 is refuted: wider ones make no system" in box.end

    def test_refuted_just_within_what_makes_a_system(self):
        """Doubling leaps over scales that make a system; the widest of them is looked at."""
        assemble, decide, _ = deciding_by(between(Fraction(1), Fraction(19, 10)))

        def fail_beyond(stretch):
            if stretch > Fraction(39, 20):
                raise AssemblyError("the stiffness is not positive")
            return assemble(stretch)

        box = find_margin(fail_beyond, decide)
        assert box.proved == 1
        assert Fraction(19, 10) <= box.refuted <= Fraction(39, 20)


class TestDwell:
    @pytest.mark.slow
    def test_published_bounds(self):
        """Geromel and Colaneri 2006: proofs above 2.75084 s, refuted up to 2.70775 s."""
        dwell = find_shortest_dwell(GEROMEL_COLANERI, quick)
        assert 2.75084 < dwell.proved < 2.7525
        assert 2.7 < dwell.refuted < 2.70776
        proof = dwell.proof
        assert proof.system.switching.dwell_time == dwell.proved
        assert all(holds(proof.system, item) for item in proof.statements)

    def test_none_is_needed(self):
        dwell = find_shortest_dwell(dayawansa_martin(5), quick)
        assert (dwell.proved, dwell.refuted, dwell.proof.verdict) == (0, None, "proved")

    @pytest.mark.parametrize("other", [[[-1]], [[2]]])
    def test_none_is_long_enough_for_an_unstable_mode(self, other):
        dwell = find_shortest_dwell(family([[1]], other), quick)
        assert dwell == DwellMargin(None, LONGEST_DWELL, None, LONGEST_DWELL)

    @pytest.mark.slow
    def test_slow_modes_need_a_long_one(self):
        """Far beyond 64 times the modes' fastest time, where the search once ended."""
        slow = family([["-0.01", 1], [-1, "-0.01"]], [["-0.01", 10], ["-0.1", "-0.01"]])
        dwell = find_shortest_dwell(slow, quick)
        assert 100 < dwell.refuted < dwell.proved < 1.01 * dwell.refuted

    @settings(deadline=None)
    @given(st.fractions("1/100", 4000), st.fractions(0, 1), st.fractions(0, 4096))
    def test_bracket_is_true_and_narrow(self, proved, share, own):
        refuted, asked = proved * share * Fraction(99, 100), []

        def decide(system):
            time = system.switching.dwell_time
            asked.append(time)
            return verdict_at(system, bracket_rule(proved, refuted))

        system = replace(ANY, switching=Switching(own))
        known = verdict_at(system, bracket_rule(proved, refuted))
        dwell = find_shortest_dwell(system, decide, known)
        assert dwell.proved >= proved
        assert dwell.refuted is not None
        size = max(proved, 1)
        assert 0 <= refuted - dwell.refuted <= 2 * size * Fraction(1, 2**REFUTED_STEPS)
        assert dwell.proved - proved <= 2 * size * Fraction(1, 2**DWELL_STEPS)
        assert {dwell.proved, dwell.refuted} <= {*asked, own}
        assert own not in asked
        assert len(set(asked)) == len(asked)

    @pytest.mark.parametrize(
        ("verdict", "proved", "refuted"),
        [(Verdict.PROVED, 3, None), (Verdict.REFUTED, None, 0), (Verdict.INCONCLUSIVE, None, None)],
    )
    def test_what_is_known_of_dwell_times_of_their_own(self, verdict, proved, refuted):
        """Proved for 3 s in one mode and none in the other: that says nothing of 0 s in both."""
        a, b = (mode.name for mode in GEROMEL_COLANERI.modes)
        own = ((a, Stay(Fraction(3))), (b, Stay()))
        system = replace(GEROMEL_COLANERI, switching=Switching(stays=own))
        dwell = find_shortest_dwell(system, undecided, verdict_at(system, lambda time: verdict))
        assert (dwell.proved, dwell.refuted) == (proved, refuted)

    def test_the_range_searched_is_told(self):
        asked = []

        def decide(system):
            asked.append(system.switching.dwell_time)
            return undecided(system)

        dwell = find_shortest_dwell(ANY, decide)
        assert dwell == DwellMargin(None, None, None, LONGEST_DWELL)
        assert max(asked) == LONGEST_DWELL


@pytest.mark.parametrize(
    ("name", "said"),
    [("oscillator-range", "constant matrices only"), ("ando-shih", "continuous time")],
)
def test_no_dwell_time_for_ranges_and_discrete_time(name, said):
    result = run_certification(read_spec(EXAMPLES / f"{name}.nrs.yaml"), limits=QUICK)
    with pytest.raises(DesignError, match=said):
        run_proof_margins(result, QUICK, margin=False, shortest_dwell=True)
