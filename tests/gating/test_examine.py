"""What the gate makes of a verdict: the status of every obligation, and never a better one."""

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace

import pytest

from nrs_design.certificates.certificate import Certificate
from nrs_design.design.goals import Achieved
from nrs_design.design.laws.law import AbstractControllerAnalysis
from nrs_design.design.measures import GAIN_MARGIN
from nrs_design.gating.examine import Examiner
from nrs_design.gating.obligations import Status
from nrs_design.pipeline.runs import run_certification
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import ARBITRARY, Stay, Switching
from nrs_design.search.certify import Limits, certify
from nrs_design.spec import read_spec
from tests.proof.evidence.test_invariant_ellipsoid import BOUNCE
from tests.proof.evidence.test_saturated_ellipsoid import HELD
from tests.proof.graphs import common_quadratic
from tests.proof.systems import bouncing, bouncing_in_steps, pushed, pushed_away
from tests.support import ROOT, SOFT_TISSUE, family, replaced
from tests.tables import rows

from .conftest import STABLE

TISSUE = SOFT_TISSUE.read_text(encoding="utf-8")
# Positive, with more digits than anybody decides about.
ENDLESS = Fraction(1, 1 << 2_000_000)
HALF_STABLE = family([[-1, 0], [0, -2]], [[0, 1], [-1, 0]])


@pytest.fixture
def examiner(tmp_path):
    return written(tmp_path, "", STABLE)


def statuses(obligations):
    return [(item.subject, item.status) for item in obligations]


def test_a_mode_of_its_own_is_decided_where_the_system_is_not(examiner):
    found = examiner.stability(HALF_STABLE, (), "nothing")
    assert statuses(found) == [
        ("m0", Status.PROVED),
        ("m1", Status.REFUTED),
        ("system", Status.INCONCLUSIVE),
    ]
    assert found[1].message == "mode m1 is not Hurwitz (eigenvalue about 0 +- 1j)"
    assert "(nothing)" in found[2].message


def test_a_refutation_is_said_of_the_system_and_of_the_mode(examiner):
    evidence = certify(HALF_STABLE).evidence
    found = examiner.stability(HALF_STABLE, (evidence,), "")
    assert statuses(found)[1:] == [("m1", Status.REFUTED), ("system", Status.REFUTED)]
    assert found[2].message == evidence.claim(HALF_STABLE)


@pytest.mark.parametrize("time", Time)
def test_numbers_that_are_too_large_leave_a_mode_undecided(examiner, time):
    digits = family([[ENDLESS]], time=time)
    mode, system = examiner.stability(digits, (), "")
    assert (mode.status, system.status) == (Status.INCONCLUSIVE, Status.INCONCLUSIVE)
    assert "too large to decide" in mode.message


@pytest.mark.parametrize(
    ("entry", "status", "words"),
    [
        (-1, Status.PROVED, "mode m0 is Hurwitz"),
        (1, Status.MET, "mode m0 is not Hurwitz, but it must be left in time"),
        (ENDLESS, Status.MET, "mode m0 must be left in time, stable or not"),
    ],
)
def test_a_mode_that_must_be_left_may_be_unstable(examiner, entry, status, words):
    stays = (("m0", Stay(Fraction(1), Fraction(2))),)
    system = replace(family([[entry]], [[-1]]), switching=Switching(stays=stays))
    first = examiner.stability(system, (), "")[0]
    assert (first.status, first.message) == (status, words)
    assert system.switching != ARBITRARY


def ranges(highest, limit):
    examiner = Examiner(read_spec(SOFT_TISSUE))
    loop = SimpleNamespace(contact=SimpleNamespace(has_memory=False))
    item = SimpleNamespace(
        name="insertion",
        given=examiner.loaded.spec.controllers["insertion"],
        highest_stiffness=highest,
        lowest_limit=limit,
        problem=SimpleNamespace(loop=loop),
    )
    (found,) = examiner.stiffness_ranges(SimpleNamespace(impedance=[item]))
    return found


@pytest.mark.parametrize(
    ("limit", "status", "verb"), rows(__file__, "test_a_range_that_touches_the_limit_is_missed")
)
def test_a_range_that_touches_the_limit_is_missed(limit, status, verb):
    found = ranges(1.0, limit)
    assert found.status is Status[status]
    assert verb in found.message
    assert "not a proof" in found.message


@pytest.mark.parametrize(
    ("goal", "more", "statuses"), rows(__file__, "test_goals_are_met_missed_not_judged_or_not_set")
)
def test_goals_are_met_missed_not_judged_or_not_set(examiner, goal, more, statuses):
    item = AbstractControllerAnalysis("a", [Achieved(GAIN_MARGIN, 2.5, "soft", goal, **more)])
    found = examiner.goals(SimpleNamespace(measured=[item]))
    assert [obligation.status.name for obligation in found] == statuses


def certificate_of(system, *statements):
    return Certificate("s", "0", None, {}, system, statements, "0")


def written(path, more, text=TISSUE):
    """Return the examiner of a spec with more lines."""
    (path / "wanting.nrs.yaml").write_text(text + more, encoding="utf-8")
    return Examiner(read_spec(path / "wanting.nrs.yaml"))


def wanting(path, goals):
    return written(path, f"\ndisturbances: {{command: 8 deg/s}}\ngoals: {goals}\n")


@pytest.mark.parametrize(
    ("goals", "level", "ends"), rows(__file__, "test_goals_that_a_certificate_must_show")
)
def test_goals_that_a_certificate_must_show(tmp_path, goals, level, ends):
    """The decay rate of the proof is 1/2 1/s; without a bound on everything, none is shown."""
    system = pushed(bouncing())
    proof = common_quadratic(((1, 0), (0, 1)), 0, Fraction(1, 2))
    bounds = () if level is None else (replace(BOUNCE, level=Fraction(level)),)
    certificate = certificate_of(system, proof, *bounds)
    found = list(wanting(tmp_path, goals).certified_goals(certificate))
    assert [item.status.name for item in found] == ends
    assert all(item.rule.id == "NRS108" and item.line for item in found)
    if level is not None:
        assert "while |push| <= 0.25 N and nothing else disturbs, the force" in found[0].message
    none = wanting(tmp_path, goals).certified_goals(None)
    assert {item.status for item in none} <= {Status.INCONCLUSIVE}


@pytest.mark.parametrize(
    ("goal", "level", "status", "said"),
    rows(__file__, "test_the_force_that_motions_decay_from_is_held_against_the_certificate"),
)
def test_the_force_that_motions_decay_from_is_held_against_the_certificate(
    tmp_path, goal, level, status, said
):
    proof = common_quadratic(((1,),), 0, Fraction(1, 2))
    shown = () if level is None else (replace(HELD, level=Fraction(level)),)
    certificate = certificate_of(pushed_away(), proof, *shown)
    text = (ROOT / "docs/examples/saturating.nrs.yaml").read_text("utf-8")
    (found,) = written(tmp_path, "", text.replace("0.5 N*m", goal)).certified_goals(certificate)
    assert found.status is Status[status]
    assert found.rule.id == "NRS108"
    assert said in found.message


def test_a_rate_per_step_counts_in_seconds(tmp_path):
    """rho = 0.95 in steps of a tenth of a second is at least 1/2 1/s."""
    proof = common_quadratic(((1, 0), (0, 1)), 0, Fraction("0.95"))
    for goal, status in (("0.5 1/s", Status.PROVED), ("0.6 1/s", Status.INCONCLUSIVE)):
        certificate = certificate_of(bouncing_in_steps(), proof)
        examiner = wanting(tmp_path, f"{{decay_rate: {goal}}}")
        assert [item.status for item in examiner.certified_goals(certificate)] == [status]


@pytest.mark.parametrize(
    ("delay", "wanted", "status"), rows(__file__, "test_a_delay_that_a_certificate_must_show")
)
def test_a_delay_that_a_certificate_must_show(tmp_path, delay, wanted, status):
    said = f"\nsampling: {{period: 2 ms, delay: {delay}}}\ngoals: {{delay: {wanted}}}\n"
    examiner = written(tmp_path, said)
    proof = common_quadratic(((1, 0), (0, 1)), 0, Fraction("0.95"))
    certificate = certificate_of(bouncing_in_steps(), proof)
    (found,) = examiner.certified_goals(certificate)
    assert (found.rule.id, found.status) == ("NRS108", Status[status])
    assert f"{wanted} is wanted" in found.message
    (nothing,) = examiner.certified_goals(None)
    assert nothing.status is Status.INCONCLUSIVE
    refuted = replace(certificate, statements=(staying("a"),))
    (found,) = examiner.certified_goals(refuted)
    assert found.status is Status.INCONCLUSIVE


def test_a_limit_that_no_proof_keeps_is_warned_of(tmp_path):
    """Soft tissue, two controllers: 1.12 N m are proved at 8 deg/s, and the limit is 0.3 N m."""
    for goals, warned in (("", True), ("goals: {peak_torque: 2 N*m}\n", False)):
        disturbed = f"contact: kept\ndisturbances: {{command: 8 deg/s}}\n{goals}"
        asked, quick = written(tmp_path, disturbed), Limits(optimize_rate=False)
        certificate = run_certification(asked.loaded, limits=quick).certificate
        found = [item.message for item in asked.limits(certificate)]
        assert bool(found) == warned
        assert not warned or found[0].startswith("the limit of 0.3 N*m is not shown to be kept")


def test_modes_and_goals_stand_where_their_spec_says_them(tmp_path):
    """Assembled modes at their controller; goals at it, or at the top if it has none of its own."""
    goals = "goals: {min_gain_margin: 2}\nswitching:"
    own = "    desired_impedance_ratio: 0.5\n"
    text = replaced(
        TISSUE, ("switching:", goals), (own, f"{own}    goals: {{min_gain_margin: 3}}\n")
    )
    tissue, given = written(tmp_path, "", text), written(tmp_path, "", STABLE)
    assert tissue.keys_of_mode("withdrawal/soft/k-min") == ("controllers", "withdrawal")
    assert given.keys_of_mode(given.loaded.spec.modes[1].name) == ("modes", 1)
    assert tissue.keys_of_goal("insertion", "min_gain_margin") == ("goals", "min_gain_margin")
    assert tissue.keys_of_goal("withdrawal", "min_gain_margin")[0] == "controllers"
