"""The clamp of an integral, and saturation in the sampled loop: what is refused."""

import pytest

from nrs_design.spec import parse_spec
from tests.loop.test_sampled_saturation import FORCE, IMPEDANCE
from tests.spec.samples import refusal

CLAMP = "anti_windup: {clamp: 0.1 deg}\n"
SAMPLED = "sampling: {period: 2 ms, delay: [0, 1]}\n"


def test_the_clamp_is_an_angle_rounded_to_the_safe_side():
    clamp = parse_spec(FORCE).anti_windup.clamp
    assert clamp.si == pytest.approx(0.1 * 3.14159265 / 180)
    assert parse_spec(FORCE.replace(CLAMP, "")).anti_windup is None


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (IMPEDANCE + CLAMP, "anti_windup without a pi-force controller"),
        (FORCE.replace("0.1 deg}", "0 deg}"), "anti_windup.clamp"),
        (FORCE.replace("0.1 deg}", "-2 deg}"), "anti_windup.clamp"),
        (FORCE.replace("0.1 deg}", "2 N}"), "anti_windup.clamp"),
        (FORCE.replace("{clamp: 0.1 deg}", "{}"), "clamp"),
        (FORCE.replace("{clamp: 0.1 deg}", "{clamp: 1 deg, gain: 2}"), "gain"),
        (
            FORCE.replace(SAMPLED, "").replace("goals: {initial_force: largest}\n", ""),
            "anti_windup is what the processor does at a sample",
        ),
        # In continuous time, decay under force control although signals saturate is not modelled.
        (FORCE.replace(SAMPLED, "").replace(CLAMP, ""), "decay although signals saturate"),
        (FORCE.replace("  command: 2000 rpm\n", ""), "nothing says where the command"),
        (
            IMPEDANCE.replace("delay: 1}", "delay: 1, outer_period: 4 ms}"),
            "decay although signals saturate",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(text, said):
    assert said in str(refusal(text))
