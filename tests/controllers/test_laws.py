from dataclasses import FrozenInstanceError, fields
from fractions import Fraction
from typing import get_args

import pytest

from nrs_design.controllers.laws import LAWS, Admittance, ProportionalDerivative
from nrs_design.design.laws import LAW_DESIGNS
from nrs_design.spec import ControllerSpec
from nrs_design.spec.units import parse_unit


def test_laws_are_values():
    assert Admittance(Fraction(1), Fraction(2)) == Admittance(Fraction(1), Fraction(2))
    with pytest.raises(FrozenInstanceError):
        Admittance(Fraction(1), Fraction(2)).Bt = Fraction(3)


def test_every_type_of_controller_has_a_law_and_a_design():
    union = get_args(ControllerSpec)[0]
    types = {get_args(given.model_fields["type"].annotation)[0] for given in get_args(union)}
    assert set(LAWS) == set(LAW_DESIGNS) == types


def test_every_law_has_a_name_of_its_own_and_a_unit_for_every_gain():
    laws = (ProportionalDerivative, *LAWS.values())
    names = ["force", "impedance", "motion", "parallel", "pi-force", "position"]
    assert sorted(law.name for law in laws) == names
    for law in laws:
        assert list(law.units) == [field.name for field in fields(law)]
    # A torque over an angular velocity.
    assert parse_unit(Admittance.units["Bt"]).dimension == parse_unit("N*m/(rad/s)").dimension
    assert Admittance(Fraction(1), Fraction(2)).gains == {"Mt": 1, "Bt": 2}


def test_a_spring_is_a_gain_only_where_there_is_one():
    sprung = Admittance(Fraction(1), Fraction(2), Fraction(3))
    assert sprung.gains == {"Mt": 1, "Bt": 2, "Kt": 3}
    for law in (sprung, Admittance(Fraction(1), Fraction(2))):
        assert Admittance.of(law.gains) == law
