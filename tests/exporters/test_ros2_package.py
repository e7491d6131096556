"""The package of a ROS 2 node: what its files say, and of what they are made."""

import re
import sys
from dataclasses import replace
from types import ModuleType
from xml.etree import ElementTree

import pytest
from ruamel.yaml import YAML

from nrs_design.errors import DesignError
from nrs_design.exporters.formats.ros2_node import remarks, render


@pytest.fixture
def texts(sampled_export):
    return {
        name.removeprefix("_ros2/"): text.decode() for name, text in render(sampled_export).items()
    }


def test_the_package_names_what_it_needs_and_no_invented_person(texts):
    package = ElementTree.fromstring(texts["package.xml"])
    assert package.find("name").text == "nrs_soft_tissue"
    assert {item.text for item in package.iter("depend")} == {"rclcpp", "sensor_msgs", "std_msgs"}
    assert package.find("maintainer").text == "nobody yet"
    assert package.find("export/build_type").text == "ament_cmake"
    found = {f"{name}.hpp" for name in ("rclcpp/rclcpp", "sensor_msgs/msg/joint_state")}
    assert all(f'#include "{name}"' in texts["src/node.cpp"] for name in found)


def test_parameters_are_those_that_the_node_declares(texts):
    (parameters,) = YAML(typ="safe").load(texts["config/node.yaml"]).values()
    declared = set(
        re.findall(r'(?:declare_parameter<\S+>|nanoseconds)\("(\w+)"', texts["src/node.cpp"])
    )
    assert parameters["ros__parameters"].keys() == declared
    assert parameters["ros__parameters"]["jitter"] == pytest.approx(0.002 / 20)
    assert "kPeriod = 2000000;" in texts["src/node.cpp"]


def test_the_launch_file_starts_the_node_with_its_parameters(texts, tmp_path, monkeypatch):
    """With modules that stand for those of ROS 2."""
    for name, kind in (("launch", "LaunchDescription"), ("launch_ros.actions", "Node")):
        module = ModuleType(name)
        setattr(module, kind, lambda *args, **given: (args, given))
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setitem(sys.modules, "launch_ros", ModuleType("launch_ros"))
    file = tmp_path / "launch/node.launch.py"
    space = {"__file__": str(file), "__name__": "launched"}
    exec(compile(texts["launch/node.launch.py"], file, "exec"), space)
    (((_, node),),), _ = space["generate_launch_description"]()
    assert node["package"] == node["name"] == "nrs_soft_tissue"
    assert node["parameters"] == [str(tmp_path / "config/node.yaml")]
    assert (node["package"] + ":") in texts["config/node.yaml"]


def test_the_page_says_what_was_not_tried_and_what_is_outside(texts, sampled_export):
    page = " ".join(texts["README.md"].split())
    for words in (
        "**Not tried with ROS 2.**",
        "the proof allows 1 sample of 2 ms",
        "ROS 2 and its host promise no time",
        "The proof has the angle of the instant of the step",
        "| `servo_jv` | `sensor_msgs/JointState`, `velocity` |",
        "command of the motor in rpm",
    ):
        assert words in page
    assert "never built against ROS 2" in remarks({})[0]


def test_a_period_that_no_timer_has_is_refused(sampled_export):
    record = sampled_export.record
    third = record.sample_time.model_copy(update={"exact": "0.00000000025"})
    with pytest.raises(DesignError, match="no whole number of nanoseconds"):
        render(replace(sampled_export, record=record.model_copy(update={"sample_time": third})))
