"""What the header says of signs and of the start: the first samples, in a loop with the motor."""

import math

import numpy as np
import pytest

from nrs_design.controllers.replica import StepProgram, step
from nrs_design.exporters import program
from nrs_design.exporters.formats.c import header_text
from nrs_design.exporters.program import POSITION_START, Program, sign_lines, start_lines
from nrs_design.exporters.text import CNames
from tests.exporters.programs import LAWS, law
from tests.tables import rows

PERIOD, LAG, GAIN, STIFFNESS, DEPTH, SPRING = 0.002, 0.0351, 4.8417e-4, 43.0, 0.007, 0.5


def pressed_in(running, states, samples):
    """Let a pressed axis go, both controllers in turn; return commands and the last angle."""
    left = math.exp(-PERIOD / LAG)
    angle, speed, commands = DEPTH, 0.0, []
    for n in range(samples):
        given = {"angle": angle, "torque": STIFFNESS * angle, **states}
        values = [np.float32(given.get(v.name, 0.0)) for v in running.law.values]
        (command,), after, valid = running.step(n // 500 % 2, values)
        assert valid
        states = {s.name: value for s, value in zip(running.law.states, after, strict=True)}
        commands.append(float(command))
        wanted = GAIN * float(command)
        angle += LAG * (1 - left) * (speed - wanted) + wanted * PERIOD
        speed = left * speed + (1 - left) * wanted
    return commands, angle


def begun(one, angle):
    return {state.name: angle if state.starts_at_angle else 0.0 for state in one.states}


def test_a_spring_is_unloaded_where_the_program_starts():
    """From within contact k d Kt/(k + Kt) stays; from the surface all dies out, as is proved."""
    sprung = law(Kt=("0.5", "0.5"))
    running = StepProgram(sprung)
    _, stays = pressed_in(running, begun(sprung, DEPTH), 2_000)
    lasting = DEPTH * SPRING / (STIFFNESS + SPRING)
    assert stays == pytest.approx(lasting, rel=1e-3)
    _, gone = pressed_in(running, begun(sprung, DEPTH) | {"commanded": 0.0}, 2_000)
    assert abs(gone) < 1e-6 * lasting
    _, plain = pressed_in(StepProgram(law()), begun(law(), DEPTH), 2_000)
    assert abs(plain) < 1e-6 * lasting


def test_a_position_away_from_the_joint_is_differentiated_at_the_first_sample():
    placed = LAWS["force and position"]
    running, states = StepProgram(placed), begun(placed, DEPTH)
    (first, *_), _ = pressed_in(running, states, 1)
    Kp, D = (float(placed.coefficient[name].values[0]) for name in ("Kp", "Kd_over_T"))
    assert first == pytest.approx(-(Kp + D) * DEPTH, rel=1e-5)
    (there, *_), _ = pressed_in(running, states | {"position": DEPTH}, 1)
    assert there == 0


@pytest.mark.parametrize(("shape", "said"), rows(__file__, "test_the_header_says_where_to_start"))
def test_the_header_says_where_to_start(sampled_export, shape, said):
    said = [getattr(program, name) for name in said]
    assert list(start_lines(LAWS[shape])) == said
    text = header_text(Program(sampled_export.record, LAWS[shape], CNames("x")))
    plain = " ".join(text.replace("\n *", " ").split())
    assert all(line in plain for line in said)
    assert ("PD differentiates all" in plain) == (POSITION_START in said)


def commanded(law, mode, **inputs):
    given = {value.name: np.float32([inputs.get(value.name, 0)]) for value in law.values}
    for _ in range(10):
        result = step(law, np.array([law.modes.index(mode)], np.uint32), given)
        assert result.valid.all()
        given |= result.states
    return float(result.outputs["command"][0])


def test_a_joint_yields_to_what_pushes_it():
    """A positive torque drives it to smaller angles, a positive rate or position to larger ones."""
    law = LAWS["inertia"]
    assert commanded(law, "insertion", torque=0.1) < 0
    assert commanded(law, "insertion", velocity_command=0.1) > 0
    assert commanded(law, "insertion", angle=0.1) < 0
    placed = LAWS["force and position"]
    assert commanded(placed, "position", position=0.1) > 0
    assert commanded(placed, "force", wanted_torque=0.1) > 0
    assert commanded(placed, "force", torque=0.1) < 0


def test_the_header_has_them(sampled_export):
    text = header_text(Program(sampled_export.record, LAWS["mixed"], CNames("x")))
    words = " ".join(text.replace("\n *", " ").split())
    for line in sign_lines(LAWS["mixed"]):
        assert line in words
