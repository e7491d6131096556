"""Where it can be asked for that contact settles under a constant force, and where not."""

import re

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from tests.support import ROOT

TEXT = (ROOT / "docs/examples/pushed-in.nrs.yaml").read_text("utf-8")
SAMPLED = "sampling: {period: 2 ms, delay: 0}\n"
DAMPED = "model: kelvin-voigt\n    damping: 1 N*s/m"


def test_the_example_asks_for_it():
    assert parse_spec(TEXT).goals.constant_force == "settles"


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("contact: losable", "contact: kept", "write `contact: losable`"),
        ("contact: losable\n", "", "write `contact: losable`"),
        (
            "contact: losable",
            "contact: losable\nsampling: {period: 2 ms, delay: 0}",
            "remove sampling",
        ),
        (
            "contact: losable",
            "contact: losable\ncoupling: {inertia: [0 kg*m^2, 0.3 kg*m^2]}",
            "remove coupling",
        ),
        (
            "time_constant:",
            "load_inertia: 1.213 kg*m^2\n  time_constant:",
            "remove actuator.load_inertia",
        ),
        ("model: elastic", DAMPED, "shown for springs, not for 'soft'"),
        (
            "controllers:\n",
            "  stiff:\n    model: elastic\n    stiffness: 50 N*m/rad\ncontrollers:\n"
            "  tool: {type: impedance, environment: stiff, Mt: 0.01 kg*m^2, Bt: 2 N*m*s/rad}\n",
            "let all controllers touch the same environment",
        ),
        ("Bt: 1.04 N*m*s/rad", "Bt: 1.04 N*m*s/rad, Kt: 1 N*m/rad", "remove Kt"),
        ("constant_force: settles", "constant_force: moves", "settles"),
        ("Bt: 1.04", "goals: {constant_force: settles}, Bt: 1.04", "all controllers together"),
    ],
)
def test_what_nothing_is_claimed_about_is_refused(old, new, what):
    assert old in TEXT
    with pytest.raises(SpecError, match=re.escape(what)):
        parse_spec(TEXT.replace(old, new, 1))


def test_an_environment_that_is_not_there_is_a_fault_of_its_own():
    with pytest.raises(SpecError, match="soft") as caught:
        parse_spec(TEXT.replace("  soft:\n", "  other:\n"))
    assert "shown for springs" not in str(caught.value)


def test_several_environments_at_once_are_refused():
    text = TEXT.replace(
        "controllers:\n", "  more:\n    model: elastic\n    stiffness: 50 N*m/rad\ncontrollers:\n"
    ).replace("environment: soft", "environment: soft, contacts: [[soft, more]]")
    with pytest.raises(SpecError, match="one deflection in one environment"):
        parse_spec(text)
