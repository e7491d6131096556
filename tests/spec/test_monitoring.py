"""What a spec says of the readings of a running loop."""

import pytest

from nrs_design.spec import parse_spec
from nrs_design.spec.describe import describe
from tests.support import ROBOT

TEXT = (ROBOT / "soft-tissue-sampled.nrs.yaml").read_text(encoding="utf-8")
SAID = "torque_noise: 2 N*mm, angle_noise: 0.005 deg, surface: free"


def read(said=SAID, more=""):
    return parse_spec(f"{TEXT}\nmonitoring: {{{said}}}\n{more}")


def test_bounds_in_si() -> None:
    monitoring = read().monitoring
    assert monitoring.torque_noise.si == 0.002
    assert monitoring.angle_noise.si == pytest.approx(8.7266e-5, rel=1e-4)
    lines = {line.name: line.written for line in describe(read())}
    assert lines["monitoring.surface"] == "free"
    assert lines["monitoring.torque_noise"] == "2 N*mm"


def test_half_a_step_is_enough() -> None:
    read(more="disturbances: {encoder_step: 0.01 deg, force_step: 4 N*mm}\n")
    read(f"{SAID}, skew: 1 ms, speed: 20 deg/s", "sensor: {bias: 2 N*mm}\n")
