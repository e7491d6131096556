"""The two sentences and the lights: no more than the claim."""

import re
from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.gating.examine import Examiner
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_certification
from nrs_design.proof.evidence import Shows
from nrs_design.proof.mode import Time
from nrs_design.reporting.sections.goals import goals_section, judged_goals
from nrs_design.reporting.sections.head import lights_of, summary_of
from nrs_design.spec import read_spec
from tests.proof.graphs import common_quadratic
from tests.proof.systems import bouncing, pushed
from tests.reporting.conftest import cases, recorded
from tests.support import FORCE_LIMIT, ROOT, SOFT_TISSUE
from tests.tables import rows


@pytest.mark.parametrize(
    ("case", "said"), rows(__file__, "test_the_first_sentence_says_what_was_shown")
)
def test_the_first_sentence_says_what_was_shown(report, case, said):
    assert said in report(case).summary[0]


def test_a_step_is_said_in_seconds_where_it_has_some(soft_tissue):
    certification = soft_tissue.certification
    system = replace(certification.system, time=Time.DISCRETE, sample_time=Fraction(1, 500))
    slow = (replace(certification.evidence, rate=Fraction(99, 100)),)
    decided = replace(certification, system=system, statements=slow)
    stepping = replace(soft_tissue, certification=decided)
    assert re.search(r"time constant at most 200 ms, rho = 0\.99 per step", summary_of(stepping)[0])


def test_free_motion_is_named_only_where_its_loss_is_covered():
    """The function of kept contact says nothing about the modes of free motion."""
    result = run_certification(read_spec(SOFT_TISSUE))
    conewise = result.certification.evidence
    kept = common_quadratic(conewise.nodes[0].form, conewise.denominator_log2, conewise.rate)
    without = replace(result, certification=replace(result.certification, statements=(kept,)))
    assert "among 4 modes, contact may be lost" in summary_of(result)[0]
    assert "among 4 modes, as long as contact is kept" in summary_of(without)[0]
    # Where it is no mode at all, too.
    assert "as long as contact is kept" in summary_of(run_certification(read_spec(FORCE_LIMIT)))[0]


def test_disturbances_without_a_proved_bound_are_said_in_the_lead(soft_tissue):
    certification = soft_tissue.certification
    channels = pushed(bouncing()).channels
    system = replace(certification.system, channels=channels)
    disturbed = replace(soft_tissue, certification=replace(certification, system=system))
    said = "; no bound under the disturbances of the spec is proved."
    assert summary_of(disturbed)[0].endswith(said)
    assert "no bound" not in summary_of(soft_tissue)[0]


def test_a_motor_without_ranges_is_not_said_to_have_them(soft_tissue):
    assert "the motor is linear, and has no tolerance" in summary_of(soft_tissue)[1]


def test_a_refuted_sampled_loop_is_one_of_exact_arithmetic():
    """In the summary; the claim says that no corner of the enclosure need be a motor."""
    result = run_certification(read_spec(ROOT / "docs/examples/late-force.nrs.yaml"))
    system, evidence = result.certification.system, result.certification.evidence
    assert evidence.shows is Shows.INSTABILITY
    assert "for exact arithmetic" in summary_of(result)[0]
    assert "the growth is that of all maps between" in evidence.claim(system)


@pytest.mark.parametrize(
    "case", cases(("dwell", "inconclusive", "resets", "parameter", "dwell-refuted"))
)
def test_arbitrary_switching_is_claimed_only_where_it_is_declared(report, case):
    assert "any switching among" not in report(case).summary[0]


def test_the_rate_is_not_above_that_of_the_claim(report):
    for case in ("proved", "dwell", "polynomial"):
        (said,) = re.findall(r"alpha >?= ([0-9.]+) 1/s", report(case).summary[0])
        assert said in report(case).claim


def test_the_second_sentence_names_every_assumption_of_the_register(report):
    section = next(part for part in report("proved").sections if part.title == "Assumptions")
    names = {row[0] for row in section.blocks[1].rows}
    assert all(name in report("proved").summary[1] for name in names)
    assert len(section.blocks[1].rows) == 12


def lights(report):
    return {light.name: (str(light.state), light.text) for light in report.lights}


def test_lights_of_a_design(report):
    found = lights(report("proved"))
    assert found["Proof"][0] == "good"
    assert found["Goals"] == ("unknown", "no goals set")
    assert found["Design"] == ("doubtful", "3 warnings (no part of the proof)")
    assert found["Data"][0] == "unknown"
    first, worst = report("proved").key[0]
    assert first == "Worst of it"
    assert worst.startswith("withdrawal: sensitivity peak Ms 3.753")
    assert worst.endswith("(2 more warnings)")
    assert lights(report("refuted"))["Proof"][0] == "bad"
    assert lights(report("inconclusive"))["Proof"][0] == "doubtful"


@pytest.mark.parametrize(
    ("goals", "state", "said"), rows(__file__, "test_the_light_of_goals_follows_from_all_of_them")
)
def test_the_light_of_goals_follows_from_all_of_them(soft_tissue, tmp_path, goals, state, said):
    """What is proved decides the goals of the certificate here as it does in the gate."""
    result = asking(soft_tissue, tmp_path / "a.nrs.yaml", goals)
    analysis = run_analysis(result.designed)
    (light,) = (x for x in lights_of(result, analysis) if x.name == "Goals")
    assert (str(light.state), light.text) == (state, said)
    tables = {b.title: b for b in goals_section(result, analysis).blocks if hasattr(b, "rows")}
    (row,) = tables["Goals that the certificate must show"].rows
    gated = next(Examiner(result.loaded).certified_goals(result.certificate))
    assert f"{row[2]}; {row[1]} is wanted" == gated.message
    assert row[3] == ("proved" if gated.fulfilled else "NOT PROVED")


@pytest.fixture(scope="module")
def soft_tissue():
    return run_certification(read_spec(SOFT_TISSUE))


def asking(result, path, goals):
    text = result.loaded.path.read_text(encoding="utf-8")
    path.write_text(f"{text}goals: {{{goals}}}\n", encoding="utf-8")
    loaded = read_spec(path)
    designed = replace(result.designed, loaded=loaded, spec=loaded.spec)
    return replace(result, loaded=loaded, designed=designed)


def test_goals_of_margins_that_do_not_exist_are_not_met(soft_tissue, tmp_path):
    goals = "decay_rate: 0.5 1/s, min_gain_margin: 2"
    state, said = judged_goals(asking(soft_tissue, tmp_path / "a.nrs.yaml", goals), None)
    assert state == "doubtful"
    assert said == "not computed: a nominal loop is unstable; proved: decay_rate"


@pytest.mark.parametrize(("data", "more", "state"), rows(__file__, "test_the_light_of_data"))
def test_the_light_of_data(tmp_path, data, more, state):
    lights = lights_of(run_certification(recorded(tmp_path, data, more)), None)
    assert [str(light.state) for light in lights if light.name == "Data"] == [state]
