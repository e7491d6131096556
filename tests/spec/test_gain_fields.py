"""Gains in a spec: fixed, designed within bounds, and the range that the proof covers."""

from fractions import Fraction

import pytest
from jsonschema import Draft7Validator
from ruamel.yaml import YAML

from nrs_design.spec import GainSpec, ImpedanceControllerSpec, describe
from nrs_design.spec.schema import json_schema

from .samples import IMPEDANCE, assert_refused, interaction, place_of, refusal, spoiled

BT = "{min: 0.1 N*m*s/rad, max: 20 N*m*s/rad}"
MT = "Mt: 0.01 kg*m^2"
HEAVY = "{nominal: 0.01 kg*m^2, range: [8000 g*cm^2, 0.012 kg*m^2]}"


def insertion(text: str) -> ImpedanceControllerSpec:
    controller = interaction(text).controllers["insertion"]
    assert isinstance(controller, ImpedanceControllerSpec)
    return controller


def ends(gain: GainSpec) -> list[Fraction]:
    assert gain.range is not None
    return [end.exact for end in gain.range]


def test_without_a_range() -> None:
    controller = insertion(IMPEDANCE)
    assert (controller.Mt.range, controller.Bt.range) == (None, None)
    assert not controller.Mt.ranged
    assert controller.Mt.fixed


def test_nominal_alone_is_a_fixed_gain() -> None:
    gain = insertion(spoiled(IMPEDANCE, BT, "{nominal: 2 N*m*s/rad}")).Bt
    assert (gain.min.exact, gain.max.exact, gain.fixed, gain.ranged) == (2, 2, True, False)


def test_range_of_a_fixed_gain_in_its_own_units() -> None:
    gain = insertion(spoiled(IMPEDANCE, MT, f"Mt: {HEAVY}")).Mt
    assert gain.fixed
    assert gain.ranged
    # 8000 g cm^2 = 0.0008 kg m^2.
    assert ends(gain) == [Fraction("0.0008"), Fraction("0.012")]


def test_range_of_a_designed_gain() -> None:
    gain = insertion(spoiled(IMPEDANCE, "s/rad}\n", "s/rad, range: [2 kg*m^2/s, 3 kg*m^2/s]}\n")).Bt
    assert not gain.fixed
    assert gain.ranged
    assert ends(gain) == [2, 3]


def test_listing() -> None:
    text = spoiled(spoiled(IMPEDANCE, MT, f"Mt: {HEAVY}"), BT, BT[:-1] + f", range: {RANGE}}}")
    rows = {row.name: row for row in describe.describe(interaction(text))}
    name = "controllers.insertion"
    assert rows[f"{name}.Mt"].written == "0.01 kg*m^2"
    assert rows[f"{name}.Mt.range"].written == "[8000 g*cm^2, 0.012 kg*m^2]"
    assert rows[f"{name}.Mt.range"].value == "[0.0008, 0.012]"
    assert rows[f"{name}.Bt"].value == "[0.1, 20]"
    assert rows[f"{name}.Bt.range"][2:] == ("[2, 3]", "N*m*s/rad")


RANGE = "[2 N*m*s/rad, 3 N*m*s/rad]"
DAMPING_FAULTS = [
    ("{nominal: 2 N*m*s/rad, range: [3 N*m*s/rad, 1 N*m*s/rad]}", "[3 N", "below its start"),
    (f"{{nominal: 1 N*m*s/rad, range: {RANGE}}}", "[2 N", "'1 N*m*s/rad' is outside the range"),
    (f"{{min: 4 N*m*s/rad, max: 5 N*m*s/rad, range: {RANGE}}}", "[2 N", "no value in common"),
    (f"{{min: 0.1 N*m*s/rad, max: 1 N*m*s/rad, range: {RANGE}}}", "[2 N", "no value in common"),
    ("{nominal: 2 N*m*s/rad, range: [0 N*m*s/rad, 3 N*m*s/rad]}", "0 N", "without damping"),
    ("{nominal: 2 N*m*s/rad, range: [-1 N*m*s/rad, 3 N*m*s/rad]}", "-1 N", "zero or positive"),
    ("{nominal: 2 N*m*s/rad, range: [1 kg*m^2, 3 N*m*s/rad]}", "1 kg*m^2, 3", "not an impedance"),
    ("{nominal: 2 N*m*s/rad, range: 3 N*m*s/rad}", "3 N*m*s/rad}", "[lowest, highest]"),
    ("{nominal: 2 N*m*s/rad, range: [1 N*m*s/rad]}", "[1 N", "[lowest, highest]"),
    ("{nominal: 2 N*m*s/rad, range: [nan N*m*s/rad, 3 N*m*s/rad]}", "nan", "number"),
    ("{nominal: 2 N*m*s/rad, rang: [1 N*m*s/rad]}", "rang:", "did you mean range?"),
    (
        "{nominal: 2 N*m*s/rad, max: 3 N*m*s/rad}",
        "3 N*m*s/rad}",
        "nominal and max exclude each other",
    ),
    (f"{{range: {RANGE}}}", "{range", "`min` is missing"),
    (f"{{max: 3 N*m*s/rad, range: {RANGE}}}", "{max", "`min` is missing"),
    (RANGE, "[2 N", "expected a mapping"),
]


@pytest.mark.parametrize(("gain", "at", "said"), DAMPING_FAULTS)
def test_refuses_with_place_and_remedy(gain: str, at: str, said: str) -> None:
    assert_refused(spoiled(IMPEDANCE, BT, gain), said, at)


@pytest.mark.parametrize("nominal", ["0 kg*m^2", "0.01 kg*m^2"])
def test_inertia_cannot_reach_zero(nominal: str) -> None:
    text = spoiled(IMPEDANCE, MT, f"Mt: {{nominal: {nominal}, range: [0 kg*m^2, 1 kg*m^2]}}")
    error = refusal(text)
    assert "one state less" in error.message
    assert "positive ends" in str(error.remedy)
    assert (error.line, error.column) == place_of(text, "0 kg*m^2, 1")


RANGED_GAINS = [
    ("2 N*m*s/rad", True),
    ("{nominal: 2 N*m*s/rad}", True),
    (f"{{nominal: 2 N*m*s/rad, range: {RANGE}}}", True),
    (f"{{min: 1 N*m*s/rad, max: 9 N*m*s/rad, range: {RANGE}}}", True),
    (f"{{range: {RANGE}}}", False),
    (f"{{min: 1 N*m*s/rad, range: {RANGE}}}", False),
    ("{nominal: 2 N*m*s/rad, max: 3 N*m*s/rad}", False),
    ("{nominal: 2 N*m*s/rad, range: [2 N*m*s/rad]}", False),
]


@pytest.mark.parametrize(("gain", "fits"), RANGED_GAINS)
def test_schema_and_reader_agree(gain: str, fits: bool) -> None:
    text = spoiled(IMPEDANCE, BT, gain)
    data = YAML(typ="safe", pure=True).load(text)
    assert Draft7Validator(json_schema()).is_valid(data) is fits
    if fits:
        interaction(text)
    else:
        refusal(text)


SPRINGS = [
    ("0.5 N*m/rad", True),
    ("{nominal: 0.5 N*m/rad, range: [0.2 N*m/rad, 1 N*m/rad]}", True),
    ("{min: 0.2 N*m/rad, max: 1 N*m/rad}", False),
]


@pytest.mark.parametrize(("gain", "fits"), SPRINGS)
def test_a_spring_is_given(gain: str, fits: bool) -> None:
    text = spoiled(IMPEDANCE, BT, f"2 N*m*s/rad\n    Kt: {gain}")
    data = YAML(typ="safe", pure=True).load(text)
    assert Draft7Validator(json_schema()).is_valid(data) is fits
    if fits:
        interaction(text)
    else:
        assert "chooses Mt and Bt only" in refusal(text).message


@pytest.mark.parametrize(
    ("gain", "said"),
    [
        ("0 N*m/rad", "positive"),
        ("0.5 N*m", "per radian"),
        ("{nominal: 0.5 N*m/rad, range: [0 N*m/rad, 1 N*m/rad]}", "nothing draws"),
    ],
)
def test_refuses_a_spring(gain: str, said: str) -> None:
    assert_refused(spoiled(IMPEDANCE, BT, f"2 N*m*s/rad\n    Kt: {gain}"), said)
