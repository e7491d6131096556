"""Where it can be asked for from which force motions decay under saturation, and where not."""

import re

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import doubt_spec, parse_spec
from tests.support import ROOT

TEXT = (ROOT / "docs/examples/saturating.nrs.yaml").read_text("utf-8")
DAMPED = "model: kelvin-voigt\n    damping: 1 N*s/m"


def test_the_example_asks_for_it():
    assert parse_spec(TEXT).goals.initial_force.text == "0.5 N*m"
    largest = TEXT.replace("initial_force: 0.5 N*m", "initial_force: largest")
    assert parse_spec(largest).goals.initial_force == "largest"


def test_damped_contact_that_is_kept_is_modelled():
    text = TEXT.replace("model: elastic", DAMPED)
    assert parse_spec(text.replace("contact: losable", "contact: kept")).goals is not None


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("  command: 2000 rpm\n", "", "add `command` to the limits, in rpm"),
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
            "  derivative_gain: 2060 rpm*s/rad\n  zero: 56.9706 1/s\n",
            "  transfer_function: {numerator: [28.4, 1619], denominator: [1, 57, 1619]}\n",
            "remove motion_loop.transfer_function",
        ),
        ("contact: losable", "contact: kept\ncoordinates: force", "remove coordinates: force"),
        ("model: elastic", DAMPED, "write `contact: kept`"),
        ("contact: losable\n", "", None),
        ("Bt: 1.04 N*m*s/rad", "Bt: 1.04 N*m*s/rad, Kt: 1 N*m/rad", "without a spring Kt"),
        ("initial_force: 0.5 N*m", "initial_force: most", "write '0.5 N*m', or 'largest'"),
        ("initial_force: 0.5 N*m", "initial_force: 0.5 N", "multiply it by its lever arm"),
        ("Bt: 1.04", "goals: {initial_force: largest}, Bt: 1.04", "all controllers together"),
        (
            "model: elastic\n    stiffness: {nominal: 747.1461 N/m, range: [720.56 N/m, "
            "768.17 N/m]}",
            "model: maxwell\n    stiffness: 747.1461 N/m\n    damping: 100 N*s/m",
            "which is maxwell",
        ),
    ],
)
def test_what_nothing_is_claimed_about_is_refused(old, new, what):
    assert old in TEXT
    text = TEXT.replace(old, new, 1)
    if what is None:
        assert parse_spec(text).contact is None
        return
    with pytest.raises(SpecError, match=re.escape(what)):
        parse_spec(text)


@pytest.mark.parametrize(
    ("force", "doubted"), [("3 N*m", False), ("3.01 N*m", True), ("largest", False)]
)
def test_a_force_far_above_the_torque_limit_is_doubted(force, doubted):
    """The example wants more than the limit of 0.3 N m: there signals saturate."""
    doubts = list(doubt_spec(parse_spec(TEXT.replace("0.5 N*m", force))))
    assert len(doubts) == doubted
    for doubt in doubts:
        assert doubt.at == ("goals", "initial_force")
        assert "more than 10 times limits.torque of 0.3 N*m: is that its unit?" in str(doubt)


def test_several_environments_at_once_are_refused():
    text = TEXT.replace(
        "controllers:\n", "  more:\n    model: elastic\n    stiffness: 50 N*m/rad\ncontrollers:\n"
    ).replace("environment: soft", "environment: soft, contacts: [[soft, more]]")
    with pytest.raises(SpecError, match="touched one by one"):
        parse_spec(text)
