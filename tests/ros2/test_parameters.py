"""Parameters as ROS 2 reads them."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.ros2.parameters import read_bool, read_double, read_integer, read_nodes
from tests.tables import rows


@pytest.mark.parametrize("text", ["5", "-5", "+3"])
def test_an_integer_is_no_double(text):
    """rcl_yaml_param_parser tells types by the text; a node that declares a double refuses it."""
    with pytest.raises(SpecError, match="integer for ROS 2") as caught:
        read_double(text)
    assert caught.value.remedy == f"write {text}.0"


@pytest.mark.parametrize(("kind", "right", "wrong", "said"), rows(__file__, "test_one_value"))
def test_one_value(kind, right, wrong, said):
    read = {"double": read_double, "bool": read_bool, "integer": read_integer}[kind]
    assert {text: read(text) for text in right} == right
    for text in wrong:
        with pytest.raises(SpecError, match=said):
            read(text)


def test_nodes_by_name_and_dots_as_levels(tmp_path):
    file = tmp_path / "a.yaml"
    file.write_text(
        "/left:\n  arm:\n    ros__parameters:\n      admittance.mass: [1.0]\n"
        "      ft_sensor: {filter_coefficient: 0.1}\n"
        "/**:\n  ros__parameters: {use_sim_time: true}\n"
    )
    first, second = read_nodes(file)
    assert (first.name, second.name) == ("left/arm", "**")
    assert set(first.values) == {"admittance.mass", "ft_sensor.filter_coefficient"}
    assert first.places["admittance.mass"].line == 4


def test_what_is_no_parameter_file(tmp_path):
    file = tmp_path / "a.yaml"
    file.write_text("kind: robot\n")
    with pytest.raises(SpecError, match="ros__parameters"):
        read_nodes(file)
