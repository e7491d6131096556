"""The sensor of an interaction design: what is read, and what is refused at its place."""

from __future__ import annotations

import pytest
from jsonschema import Draft7Validator
from ruamel.yaml import YAML

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from nrs_design.spec.describe import describe
from nrs_design.spec.schema import json_schema
from tests.support import SOFT_TISSUE

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


def test_a_resolution_stands_in_one_place() -> None:
    sampled = "sampling: {period: 2 ms, delay: 0}\ndisturbances: {force_step: 1e-3 N*m}\n"
    read(sampled)
    with pytest.raises(SpecError, match="and force_step does, too"):
        read(sampled + "sensor: {resolution: 1e-3 N*m}\n")
