"""A whole parameter file."""

from fractions import Fraction

import pytest

from nrs_design.errors import SpecError
from nrs_design.gating.obligations import Status
from nrs_design.ros2.check import Question, check_file
from nrs_design.search.certification import Limits
from tests.ros2.support import EXAMPLE, changed

SOFT = (Fraction(200), Fraction(2000))


def statuses(file, question):
    outcome = check_file(file, question, Limits(budget=10), lambda step: None)
    (found,) = outcome.specs
    return found, [item.status for item in found.obligations], outcome.notes


def test_the_example():
    found, status, notes = statuses(EXAMPLE, Question((0, 2), SOFT, None))
    assert found.verdict == "proved"
    assert status == [Status.MET, *[Status.PROVED] * 6]
    assert any("spring without damping" in note for note in notes)


@pytest.mark.slow
def test_too_stiff_says_how_stiff_it_may_be():
    stiff = (Fraction(200), Fraction(90_000))
    found, status, _ = statuses(EXAMPLE, Question((0, 0), stiff, None))
    assert found.verdict == "refuted"
    assert status.count(Status.REFUTED) == 3
    message = found.obligations[1].message
    proved, refuted = message.split("; proved for 200 to ")[1].split(" N/m, refuted for 200 to ")
    safe = Fraction(proved)
    assert 5_000 < safe < Fraction(refuted.removesuffix(" N/m")) < 90_000
    again, _, _ = statuses(EXAMPLE, Question((0, 0), (SOFT[0], safe), None))
    assert again.verdict == "proved"


def test_what_nothing_is_said_of_is_not_proved(tmp_path):
    file = changed(tmp_path, ("true, true, true, false", "true, true, true, true"))
    found, _, _ = statuses(file, Question((0, 0), SOFT, None))
    assert found.verdict == "inconclusive"
    assert "give --rotational-stiffness" in found.obligations[4].message


def test_filters_that_are_not_modelled(tmp_path):
    chain = "    sensor_filter_chain:\n      filter1: {type: a}\n    control:"
    file = changed(tmp_path, ("    control:", chain), ("      filter_coefficient: 0.5\n", ""))
    found, _, _ = statuses(file, Question((0, 0), SOFT, None))
    assert found.verdict == "inconclusive"


def test_rates(tmp_path):
    slow = changed(tmp_path, ("update_rate: 500", "update_rate: 20"))
    assert statuses(slow, Question((0, 2), SOFT, None))[0].verdict == "refuted"
    assert statuses(slow, Question((0, 2), SOFT, None, Fraction(500)))[0].verdict == "proved"
    own = changed(tmp_path, ("    joints:", "    update_rate: 20\n    joints:"))
    assert statuses(own, Question((0, 2), SOFT, None))[0].verdict == "refuted"


def test_no_rate(tmp_path):
    file = changed(tmp_path, ("    update_rate: 500\n", ""))
    with pytest.raises(SpecError, match="rate of the control loop") as caught:
        statuses(file, Question((0, 0), SOFT, None))
    assert "--rate" in caught.value.remedy


def test_what_would_not_start_is_an_error(tmp_path):
    file = changed(tmp_path, ("mass: [5.0, 5.0", "mass: [5, 5"))
    found, status, _ = statuses(file, Question((0, 0), SOFT, None))
    assert found.verdict is None
    assert status == [Status.ERROR, Status.ERROR]
    assert {item.line for item in found.obligations} == {30}


def test_no_admittance_controller(tmp_path):
    file = tmp_path / "a.yaml"
    file.write_text("arm:\n  ros__parameters: {joints: [a]}\n")
    with pytest.raises(SpecError, match="no admittance controller is among its nodes"):
        statuses(file, Question((0, 0), SOFT, None))


def test_a_controller_that_runs_without_a_node_of_its_name(tmp_path):
    other = ("    admittance_controller:", "    admittance:")
    renamed = changed(tmp_path, other)
    found, _, _ = statuses(renamed, Question((0, 2), SOFT, None))
    (caution,) = [item for item in found.cautions if "no node of this name" in item.message]
    assert caution.message.startswith("admittance: runs as")
    anyone = changed(tmp_path, other, ("\nadmittance_controller:", "\n/**:"))
    found, _, _ = statuses(anyone, Question((0, 2), SOFT, None))
    assert not any("no node" in item.message for item in found.cautions)
