"""The clamp of an integral, and saturation in the sampled loop: what is refused."""

import pytest

from nrs_design.spec import parse_spec
from tests.loop.test_sampled_saturation import FORCE

CLAMP = "anti_windup: {clamp: 0.1 deg}\n"


def test_the_clamp_is_an_angle_rounded_to_the_safe_side():
    clamp = parse_spec(FORCE).anti_windup.clamp
    assert clamp.si == pytest.approx(0.1 * 3.14159265 / 180)
    assert parse_spec(FORCE.replace(CLAMP, "")).anti_windup is None
