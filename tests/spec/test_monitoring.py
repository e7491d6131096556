"""What a spec says of the readings of a running loop."""

import pytest

from nrs_design.errors import SpecError
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


@pytest.mark.parametrize(
    ("said", "more", "message"),
    [
        (f"{SAID}, skew: 1 ms", "", "a skew moves the angle by its speed"),
        (SAID.replace("free", "anywhere"), "", "surface"),
        (SAID.replace("2 N", "0 N"), "", "must be positive"),
        (SAID, "disturbances: {encoder_step: 0.011 deg}\n", "below half of `disturbances: enc"),
        (SAID, "disturbances: {force_step: 5 N*mm}\n", "below half of `disturbances: force"),
        (SAID, "sensor: {resolution: 5 N*mm}\n", "below half of `sensor: resolution`"),
        (SAID, "sensor: {bias: 3 N*mm}\n", "is below `sensor: bias`, 3 N"),
    ],
)
def test_what_cannot_be_meant(said: str, more: str, message: str) -> None:
    with pytest.raises(SpecError, match=message) as caught:
        read(said, more)
    assert caught.value.remedy


def test_half_a_step_is_enough() -> None:
    read(more="disturbances: {encoder_step: 0.01 deg, force_step: 4 N*mm}\n")
    read(f"{SAID}, skew: 1 ms, speed: 20 deg/s", "sensor: {bias: 2 N*mm}\n")
