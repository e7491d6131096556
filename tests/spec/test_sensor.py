"""The sensor of an interaction design: what is read, and what is refused at its place."""

from __future__ import annotations

import pytest
from jsonschema import Draft7Validator
from ruamel.yaml import YAML

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from nrs_design.spec.describe import describe
from nrs_design.spec.schema import json_schema
from tests.spec.samples import refusal
from tests.support import FORCE_LIMIT, SOFT_TISSUE

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
TOOL = "{mass: 0.797 kg, center_of_mass: {x: 0 m, y: -1 mm, z: 0.2 m}}"
FULL = f"""
sensor:
  bias: 5e-3 N*m
  force_bias: 0.1 N
  pivot: {{x: 0 m, y: 0 m, z: -0.1 m}}
  drift: 1e-5 N*m/s
  tared_every: 600 s
  resolution: 1e-3 N*m
  noise_density: 1e-8 N^2*m^2*s
  filter: {{order: 2, cutoff: 30 Hz}}
  tool: {TOOL}
  pose_error: 0.5 deg
  imu_error: 1 deg
"""


def read(more: str, text: str = TEXT) -> object:
    return parse_spec(text + more, SOFT_TISSUE)


def test_everything_is_read_and_listed() -> None:
    lines = {line.name: line for line in describe(read(FULL))}
    assert lines["sensor.bias"].value == "0.005"
    assert lines["sensor.filter.order"].written == "2"
    assert lines["sensor.tool.center_of_mass.y.nominal"].value == "-0.001"
    assert lines["sensor.noise_density"].unit == "kg^2*m^4/s^3"
    data = YAML(typ="safe", pure=True).load(TEXT + FULL)
    assert Draft7Validator(json_schema()).is_valid(data)


@pytest.mark.parametrize(
    ("sensor", "said"),
    [
        ("{}", "nothing is said of the sensor"),
        ("{drift: 1e-5 N*m/s}", "drift counts with tared_every only"),
        ("{bias: 1e-3 N*m, tared_every: 60 s}", "tared_every counts with drift only"),
        ("{imu_error: 1 deg}", "imu_error counts with tool only"),
        ("{force_bias: 1 N}", "force_bias counts with pivot only"),
        ("{bias: -1 N*m}", "positive"),
        ("{bias: 1 N}", "that is a force"),
        ("{filter: {order: 5, cutoff: 30 Hz}}", "5 is not an integer from 1 to 4"),
        ("{filter: {order: 1}}", "cutoff"),
        ("{tool: {mass: 0 kg, center_of_mass: {x: 0 m, y: 0 m, z: 0 m}}}", "positive"),
        ("{bais: 1 N*m}", "did you mean bias"),
    ],
)
def test_refuses(sensor: str, said: str) -> None:
    assert said in str(refusal(f"{TEXT}sensor: {sensor}\n"))


def test_a_goal_for_the_creep_needs_a_sensor() -> None:
    goal, ranged = (
        "goals: {max_creep: 1 deg/s}\n",
        TOOL.replace("-1 mm", "{nominal: 0 mm, range: [-1 mm, 1 mm]}"),
    )
    for sensor in ("", "sensor: {filter: {cutoff: 30 Hz}}\n", f"sensor: {{tool: {TOOL}}}\n"):
        assert "a goal for the creep, and no errors" in str(refusal(TEXT + goal + sensor))
    for sensor in ("sensor: {bias: 1e-3 N*m}\n", f"sensor: {{tool: {ranged}}}\n"):
        read(goal + sensor)


def test_a_resolution_stands_in_one_place() -> None:
    sampled = "sampling: {period: 2 ms, delay: 0}\ndisturbances: {force_step: 1e-3 N*m}\n"
    read(sampled)
    with pytest.raises(SpecError, match="and force_step does, too"):
        read(sampled + "sensor: {resolution: 1e-3 N*m}\n")


@pytest.mark.parametrize("goal", ["max_creep: 1 deg/s", "max_creep_angle: 1 deg"])
def test_creep_is_of_impedance_controllers(goal: str) -> None:
    with pytest.raises(SpecError, match="is for impedance controllers"):
        read(f"sensor: {{bias: 1e-3 N*m}}\ngoals: {{{goal}}}\n", FORCE_LIMIT.read_text())
