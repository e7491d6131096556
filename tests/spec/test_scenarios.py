"""Scenarios as a spec says them, and what is wrong with bad ones."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from tests.simulation.interactions import PLACED, text_of

RUN = "command: {constant: 4 deg/s}, duration: 1 s"


@pytest.mark.parametrize(
    ("scenario", "message", "remedy"),
    [
        ("command: {constant: 4 deg/s}", "nothing says how long", "duration"),
        ("command: {constant: 4 deg/s}, duration: 0 s", "must be positive", "above zero"),
        ("command: {constant: 4 deg/s}, duration: 2 h", "unit", ""),
        ("command: {constant: 4 deg/s}, duration: 4000 s", "not simulated", "3600"),
        ("command: {points: [[0 s, 0 deg/s], [0 s, 1 deg/s]]}", "'0 s' is not simulated", ""),
        ("command: {points: [[0 s, 0 deg/s]]}", "two at least", "[[0 s"),
        ("command: {points: [[0 s, 0 deg/s], [2 s, nan deg/s]]}", "nan", ""),
        ("command: {points: [[1 s, 0 deg/s], [2 s, 1 deg/s]]}", "not in order", "begin at 0 s"),
        ("command: {points: [[0 s, 0 deg/s], [2 s, 9 deg/s]]}", "beyond the limit", "less"),
        ("command: {constant: 8.001 deg/s}, duration: 1 s", "beyond the limit", "velocity"),
        ("command: {sinusoid: {amplitude: 7 deg/s, frequency: 1 Hz, offset: -2 deg/s}}, "
         "duration: 1 s", "beyond the limit", ""),
        ("command: {}, duration: 1 s", "in one way", "sinusoid"),
        ("command: {constant: 1 deg/s, csv: a.csv}, duration: 1 s", "in one way", ""),
        ("command: {csv: ../a.csv}", "below the spec's folder", "data/"),
        ("command: {csv: /etc/passwd}", "below the spec's folder", ""),
        (RUN + ", surfaces: [{environment: soft, at: -1 deg}]", "rests inside 'soft'", "start"),
        (RUN + ", surfaces: [{environment: soft, at: 1 deg, side: below}]", "rests inside", ""),
        (RUN + ", surfaces: [{environment: sofd, at: 1 deg}]", "no environment 'sofd'", "soft?"),
        (RUN + ", control: {fixed: insert}", "no controller 'insert'", "insertion?"),
        (RUN + ", control: {sign: {insertion: a, withdrawal: withdrawal}}", "no controller 'a'",
         ""),
        (RUN + ", control: {logic: mode-logic}", "no mode_logic", "add one"),
        (RUN + ", control: {contact: {sofd: insertion}}", "no environment 'sofd'", ""),
        (RUN + ", control: {schedule: [[1 s, insertion]]}", "not in order", "[[0 s"),
        (RUN + ", seed: -1", "is not an integer from 0", "write an integer"),
        (RUN + ", errors: {jitter: 1}", "between 0 and 1", ""),
        (RUN + ", errors: {friction: 2 V}", "commands in V", "write it in rpm"),
        (RUN + ", durration: 1 s", "unknown key", "duration"),
    ],
)  # fmt: skip
def test_a_bad_scenario_is_told_at_its_place(scenario, message, remedy):
    text = text_of(scenario=scenario)
    with pytest.raises(SpecError) as caught:
        parse_spec(text)
    assert message in caught.value.message
    assert remedy in caught.value.remedy
    assert "scenarios:" in text.splitlines()[caught.value.line - 1]


def test_position_and_force_controllers_may_be_named():
    control = "{threshold: {position: position, force: force, torque: 0.27 N*m}}"
    spec = parse_spec(text_of(PLACED, scenario=f"{RUN}, control: {control}"))
    assert spec.scenarios["run"].control.threshold.force == "force"
