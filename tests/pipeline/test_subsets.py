"""What is proved of a spec where not all of it is."""

from types import SimpleNamespace

import pytest

from nrs_design.certificates.certificate import dump
from nrs_design.pipeline import run_certification, run_verification
from nrs_design.pipeline.subsets import (
    Subset,
    are_wanted,
    find_subsets,
    parts_title,
    run_subsets,
    subset_lines,
)
from nrs_design.search.certify import Limits, Verdict
from nrs_design.spec import read_spec
from tests.proof.graphs import shape_of
from tests.search.support import TEXT
from tests.support import ROOT, SOFT_TISSUE


def test_what_is_proved_with_as_little_left_out_as_possible(tmp_path):
    """Withdrawal alone is unstable with a force that is five samples old, whatever else holds."""
    text = SOFT_TISSUE.read_text(encoding="utf-8")
    path = tmp_path / "late.nrs.yaml"
    late = "sampling: {period: 2 ms, delay: [0, 5]}\ncontact: losable\n"
    path.write_text(f"{text}\n{late}", encoding="utf-8")
    result = run_certification(read_spec(path), limits=Limits(optimize_rate=False))
    assert result.certification.verdict is Verdict.INCONCLUSIVE
    assert result.certification.refuted_in == "in kept contact"
    told: list[str] = []
    (subset,) = run_subsets(result, progress=told.append)
    assert subset.left_out == ("ages of the force sample beyond the shortest",)
    assert "contact lost and made again at any time" in subset.claim
    assert told == [
        "without the loss of contact",
        "without the ranges of what is touched",
        "without ages of the force sample beyond the shortest",
    ]
    path.write_text(f"{text}\n{late}".replace("[0, 5]", "0"), encoding="utf-8")
    assert run_subsets(run_certification(read_spec(path), limits=Limits(optimize_rate=False))) == ()


@pytest.mark.slow
def test_axes_that_are_not_proved_together_are_proved_alone(tmp_path):
    """Links as heavy as two fifths of the drives are too much for both controllers."""
    links = "coupling: {inertia: [0 kg*m^2, 0.6 kg*m^2]}\nactuator:\n  load_inertia: 1.213 kg*m^2\n"
    path = tmp_path / "axes.nrs.yaml"
    path.write_text(SOFT_TISSUE.read_text().replace("actuator:\n", links))
    result = run_certification(read_spec(path), limits=Limits(optimize_rate=False, max_degree=2))
    assert result.certification.verdict is Verdict.INCONCLUSIVE
    found = run_subsets(result, Limits(optimize_rate=False, max_degree=2))
    assert ("what the axes do to each other",) in [subset.left_out for subset in found]


HEAVY = (
    TEXT.replace("GAIN, time_constant: TAU", "4.8417e-4 rad/s/rpm, time_constant: 0.0351 s, LOAD")
    .replace("LOAD", "load_inertia: 1.213 kg*m^2")
    .replace("{nominal: LOW N*m/rad, range: [LOW N*m/rad, HIGH N*m/rad]}", "43 N*m/rad")
    .replace("CONTROLLERS", "  c: {type: impedance, environment: soft, Mt: 0.01 kg*m^2, Bt: BT}")
    .replace("BT", "2 N*m*s/rad")
    + "sampling: {period: 2 ms, delay: 1}\ncontact: kept\n"
    "coupling: {inertia: [0 kg*m^2, 1.5 kg*m^2], axes: 3}\ndisturbances: {command: 8 deg/s}\n"
)


@pytest.mark.slow
def test_axes_in_the_sampled_loop_are_proved_without_one_or_the_other(tmp_path):
    """Nobody has to ask for the list: it is the answer, with what each statement needs besides."""
    path = tmp_path / "heavy.nrs.yaml"
    path.write_text(HEAVY, encoding="utf-8")
    result = run_certification(read_spec(path), limits=Limits(optimize_rate=False))
    assert result.certification.verdict is Verdict.INCONCLUSIVE
    assert are_wanted(result)
    links, sampling = find_subsets(result)
    assert links.left_out == ("what the axes do to each other",)
    assert "The axes of the robot do not act on each other." in links.needs
    assert sampling.left_out == ("the sampling",)
    assert sampling.claim.startswith("For any number of axes that act on each other")
    assert any(text.startswith("Continuous time") for text in sampling.needs)
    first, second = subset_lines((links, sampling))
    assert first.startswith("proved without what the axes do to each other: Every solution")
    assert "Then taken for granted besides: " in second
    (nothing,) = subset_lines(())
    assert nothing.startswith("nothing is proved")


LINKS = "coupling: {inertia: [0 kg*m^2, 1.5 kg*m^2], axes: 3}\n"
TURNS = HEAVY.replace("delay: 1}", "outer_period: 4 ms, delay: 0}")


@pytest.mark.slow
def test_bounds_beside_two_periods_are_those_of_a_common_one(tmp_path):
    """Decay is proved for both periods; that no bound is looked for is said, with what holds."""
    path = tmp_path / "turns.nrs.yaml"
    path.write_text(TURNS.replace(LINKS, "").replace(", load_inertia: 1.213 kg*m^2", ""))
    result = run_certification(read_spec(path), limits=Limits(optimize_rate=False))
    assert result.certification.verdict is Verdict.PROVED
    (statement,) = result.certification.statements
    assert statement.covers_rounding
    missing = [a.outcome for a in result.certification.attempts if a.step.startswith("bound on")]
    assert len(missing) == 2
    assert all("two periods, decay is proved, and no bound" in outcome for outcome in missing)
    decay, bounds = find_subsets(result)
    assert decay.left_out == ("the disturbances",)
    assert bounds.left_out == ("the outer_period",)
    assert "from rest, |force| at a step never exceeds" in bounds.claim
    assert any(text.startswith("The law runs every 0.002 s") for text in bounds.needs)
    file = tmp_path / "turns.cert.json"
    file.write_text(dump(result.certificate))
    assert run_verification(file, result).fault is None


def test_two_periods_beside_axes_are_proved_without_one_or_the_other(tmp_path):
    path = tmp_path / "turns.nrs.yaml"
    path.write_text(TURNS.replace("1.5 kg*m^2", "0.1 kg*m^2"))
    result = run_certification(read_spec(path), limits=Limits(optimize_rate=False))
    assert result.certification.verdict is Verdict.INCONCLUSIVE
    left_out = [subset.left_out for subset in find_subsets(result)]
    assert ("the outer_period",) in left_out
    assert ("what the axes do to each other",) in left_out


def test_what_two_periods_leave_unproved_is_said_in_plain_words():
    """A list of parts alone reads as if all of them together were proved."""
    decay = Subset(("the disturbances",), "Every solution decays.")
    _, none = subset_lines((decay, Subset(("the outer_period",), "")))
    said = "not proved without the outer_period either: no bound under the disturbances was found"
    assert none == said
    _, other = subset_lines((decay, Subset(("the outer_period",), "The force stays below 1 N*m.")))
    assert other.startswith("proved of another loop, without the outer_period: The force")
    certification = SimpleNamespace(
        verdict=Verdict.PROVED, system=SimpleNamespace(clock=object(), channels=(object(),))
    )
    result = SimpleNamespace(certification=certification)
    assert parts_title(result).startswith("NOT proved: any bound under the disturbances")
    certification.verdict = Verdict.INCONCLUSIVE
    assert parts_title(result).startswith("not proved together")


def test_no_list_is_made_where_nobody_asked():
    assert find_subsets(run_certification(read_spec(SOFT_TISSUE))) is None


@pytest.mark.slow
def test_everything_at_once_is_one_certificate(tmp_path):
    """Sampling, late samples, tolerance, lost contact, rounding, a command, a hand, three axes."""
    loaded = read_spec(ROOT / "docs/examples/everything-at-once.nrs.yaml")
    result = run_certification(loaded, limits=Limits(optimize_rate=False, budget=600.0))
    assert result.certification.verdict is Verdict.PROVED
    assert find_subsets(result) is None
    system = result.certification.system
    stable, force, velocity = result.certification.statements
    assert shape_of(stable) == "coupled-axes"
    assert all(item.covers_rounding and item.covers_lost_contact for item in (stable, force))
    assert [item.bound(system).output.name for item in (force, velocity)] == ["force", "velocity"]
    assert "on each of at most 3 axes that act on each other" in force.claim(system)
    file = tmp_path / "all.cert.json"
    file.write_text(dump(result.certificate), encoding="utf-8")
    assert run_verification(file, result).fault is None
