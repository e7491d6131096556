"""Signs that the header states are those that the law computes with."""

import numpy as np

from nrs_design.controllers.replica import step
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.formats.c import header_text
from nrs_design.exporters.signs import sign_lines
from tests.exporters.programs import LAWS


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
    text = header_text(sampled_export.record, LAWS["mixed"], CNames("x"))
    words = " ".join(text.replace("\n *", " ").split())
    for line in sign_lines(LAWS["mixed"]):
        assert line in words
