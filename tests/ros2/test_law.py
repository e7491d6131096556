"""The law from its parameters."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.ros2.law import is_admittance, read_law, unknown_names
from nrs_design.ros2.parameters import read_nodes
from tests.ros2.support import EXAMPLE, changed
from tests.tables import rows


def controller(file):
    return read_nodes(file)[1]


def test_the_example():
    law = read_law(controller(EXAMPLE))
    assert [axis.name for axis in law.axes] == ["x", "y", "z", "rx", "ry", "rz"]
    assert [axis.selected for axis in law.axes] == [True] * 3 + [False] * 3
    assert law.axes[0].mass == 5
    assert law.filter_coefficient * 2 == 1
    assert list(unknown_names(law.node)) == []


def test_defaults(tmp_path):
    """As declared in admittance_controller_parameters.yaml of ros2_controllers."""
    file = changed(
        tmp_path, ("      joint_damping: 5.0\n", ""), ("      filter_coefficient: 0.5\n", "")
    )
    law = read_law(controller(file))
    assert law.joint_damping == 5
    assert law.filter_coefficient * 20 == 1


@pytest.mark.parametrize(
    ("old", "new", "message"), rows(__file__, "test_what_keeps_the_controller_from_starting")
)
def test_what_keeps_the_controller_from_starting(tmp_path, old, new, message):
    with pytest.raises(SpecError) as caught:
        read_law(controller(changed(tmp_path, (old, new))))
    assert message in str(caught.value)
    assert caught.value.line is not None


@pytest.mark.parametrize(
    ("old", "new", "line"), rows(__file__, "test_a_map_in_the_place_of_a_value_is_told_at_its_key")
)
def test_a_map_in_the_place_of_a_value_is_told_at_its_key(tmp_path, old, new, line):
    wanted = "one value" if "filter" in old else "a list of 6 values"
    with pytest.raises(SpecError, match=f"expected {wanted}, found a map") as caught:
        read_law(controller(changed(tmp_path, (old, new))))
    assert caught.value.line == line


def test_a_misspelt_name_is_told(tmp_path):
    with pytest.raises(SpecError) as caught:
        read_law(controller(changed(tmp_path, ("damping_ratio:", "damping_ratios:"))))
    assert caught.value.remedy == "write admittance.damping_ratio for admittance.damping_ratios"


def test_which_nodes_are_admittance_controllers():
    manager, node = read_nodes(EXAMPLE)
    assert not is_admittance(manager, None)
    assert is_admittance(node, None)
    assert not is_admittance(node, "other/Controller")
