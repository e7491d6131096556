"""Gains in a spec: fixed, or designed within bounds."""

import pytest
from jsonschema import Draft7Validator
from ruamel.yaml import YAML

from nrs_design.spec import ImpedanceControllerSpec
from nrs_design.spec.schema import json_schema

from .samples import IMPEDANCE, interaction, refusal, spoiled

BT = "{min: 0.1 N*m*s/rad, max: 20 N*m*s/rad}"


def insertion(text: str) -> ImpedanceControllerSpec:
    controller = interaction(text).controllers["insertion"]
    assert isinstance(controller, ImpedanceControllerSpec)
    return controller


def test_one_quantity_is_a_fixed_gain() -> None:
    gain = insertion(spoiled(IMPEDANCE, BT, "2 N*m*s/rad")).Bt
    assert (gain.min.exact, gain.max.exact, gain.fixed) == (2, 2, True)


RANGE, SPRUNG = "[2 N*m*s/rad, 3 N*m*s/rad]", "2 N*m*s/rad\n    Kt: "


GAINS = [
    ("2 N*m*s/rad", True),
    ("{nominal: 2 N*m*s/rad}", False),
    ("{min: 1 N*m*s/rad, max: 9 N*m*s/rad}", True),
    (f"{{min: 1 N*m*s/rad, max: 9 N*m*s/rad, range: {RANGE}}}", False),
    ("{min: 1 N*m*s/rad}", False),
    # A spring is given.
    ("2 N*m*s/rad\n    Kt: 0.5 N*m/rad", True),
    ("2 N*m*s/rad\n    Kt: {min: 0.2 N*m/rad, max: 1 N*m/rad}", False),
]


@pytest.mark.parametrize(("gain", "fits"), GAINS)
def test_schema_and_reader_agree(gain: str, fits: bool) -> None:
    text = spoiled(IMPEDANCE, BT, gain)
    data = YAML(typ="safe", pure=True).load(text)
    assert Draft7Validator(json_schema()).is_valid(data) is fits
    if fits:
        interaction(text)
    else:
        refusal(text)
