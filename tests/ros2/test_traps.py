"""What surprises people."""

from pathlib import Path

import pytest

from nrs_design.ros2.law import read_law
from nrs_design.ros2.parameters import read_nodes
from nrs_design.ros2.traps import find_traps
from tests.ros2.support import EXAMPLE, changed
from tests.tables import rows


def traps(file):
    return list(find_traps(read_law(read_nodes(file)[1]), Path(file)))


def test_the_example_has_none():
    assert traps(EXAMPLE) == []


@pytest.mark.parametrize(
    ("old", "new", "message", "line"), rows(__file__, "test_each_at_its_place")
)
def test_each_at_its_place(tmp_path, old, new, message, line):
    found = [trap for trap in traps(changed(tmp_path, (old, new))) if message in trap.message]
    assert [trap.line for trap in found] == [line]


def test_the_frame_of_masses_depends_on_the_release(tmp_path):
    """ros2_controllers 6.4.0 (pull request 1139): along the control frame; before, the base."""
    masses = ("mass: [5.0, ", "mass: [6.0, ")
    (found,) = traps(changed(tmp_path, masses))
    assert "since ros2_controllers 6.4.0, masses act along the axes of the control frame" in (
        found.message
    )
    assert "along the axes of the base" in found.message
    one = ("control: {frame: {id: tool0}}", "control: {frame: {id: base_link}}")
    assert traps(changed(tmp_path, masses, one)) == []


def test_defaults_are_said(tmp_path):
    file = changed(
        tmp_path,
        ("      filter_coefficient: 0.5\n", ""),
        ("    enable_parameter_update_without_reactivation: false\n", ""),
    )
    messages = [trap.message for trap in traps(file)]
    assert any("default 0.05" in text for text in messages)
    assert any("on by default" in text for text in messages)
