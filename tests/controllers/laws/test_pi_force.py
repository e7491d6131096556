"""What a spec has to say of a PI: each gain once, and what its integral does meanwhile."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from tests.simulation.interactions import POSITION, text_of

KP, KI = "proportional_gain: 0.02 rad/(N*m)", "integral_gain: 0.5 rad/(N*m*s)"
BOTH = f"damping_ratio: 0.7, settling_time: 0.3 s, {KI}"


@pytest.mark.parametrize(
    ("gains", "others", "said"),
    [
        (KI, {}, "neither proportional_gain nor damping_ratio"),
        (KP, {}, "neither integral_gain nor settling_time"),
        (BOTH, {}, "integral_gain and settling_time exclude each other"),
        (f"{KP}, {KI}", {"position": POSITION}, "it is not said what the states of pi-force"),
    ],
)
def test_what_is_refused(gains, others, said):
    force = f"{{type: pi-force, environment: soft, {gains}}}"
    with pytest.raises(SpecError, match=said):
        parse_spec(text_of({**others, "force": force}))


def test_a_decay_says_what_the_integral_does_meanwhile():
    force = f"{{type: pi-force, environment: soft, {KP}, {KI}}}"
    text = text_of({"position": POSITION, "force": force}, more="idle_states: {decay: 20 1/s}")
    assert parse_spec(text).idle_states
