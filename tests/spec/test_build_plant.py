from fractions import Fraction

import pytest

from nrs_design.models.contact import LAWS, LINEAR_LAWS, Elastic
from nrs_design.models.interval import Interval
from nrs_design.spec import load_spec, parse_spec
from nrs_design.spec.build_plant import build_plant
from nrs_design.spec.environment import AbstractEnvironmentSpec
from nrs_design.spec.quantity_fields import RangedQuantity
from tests.support import SOFT_TISSUE
from tests.tables import spec_text

F = Fraction
KELVIN_VOIGT = spec_text("two-hands")


def test_soft_tissue_of_the_thesis():
    """Thesis 6.3.1.1: 747.1461 N/m at 0.24 m is 43.0356 N m/rad."""
    plant = build_plant(load_spec(SOFT_TISSUE))
    assert plant.actuator.gain == F("4.8417e-4")
    assert plant.actuator.time_constant == F("0.0351")
    soft = plant.environment("soft")
    assert soft.stiffness.nominal == F("747.1461") * F("0.0576")
    assert float(soft.stiffness.nominal) == pytest.approx(43.0356, rel=1e-5)
    assert soft.stiffness.low == F("720.56") * F("0.0576")
    assert soft.law is Elastic


def test_lever_arm_applies_to_stiffness_and_damping():
    """Surgeon's hand, 1002 +- 568 N/m at 0.24 m: 25.0 to 90.4 N m/rad."""
    plant = build_plant(
        parse_spec(SOFT_TISSUE.read_text().replace("controllers:\n", KELVIN_VOIGT, 1))
    )
    hand = plant.environment("hand")
    assert float(hand.stiffness.low) == pytest.approx(24.998, abs=1e-3)
    assert float(hand.stiffness.high) == pytest.approx(90.432, abs=1e-3)
    assert hand.ranges[1] == Interval(5 * F("0.0576"), F(0), 10 * F("0.0576"))
    rotational = plant.environment("rotational")
    assert rotational.stiffness == Interval.point(F(43))
    assert rotational.ranges[1] == Interval.point(F(1, 2))


def test_every_environment_of_a_spec_has_its_law():
    """Its keys are those of the ranges that the spec declares."""
    specs = {
        field.annotation.__args__[0]: spec
        for spec in AbstractEnvironmentSpec.__subclasses__()
        if (field := spec.model_fields["model"])
    }
    assert specs.keys() >= LAWS.keys() | LINEAR_LAWS.keys()
    # A power law stands as a spring beside a damper, by the keys of these.
    power = specs.pop("hunt-crossley")
    keys = [k for k, f in power.model_fields.items() if f.annotation is RangedQuantity]
    assert tuple(keys) == LINEAR_LAWS["kelvin-voigt"].keys
    for name, law in LINEAR_LAWS.items():
        spec = specs[name]
        keys = [k for k, f in spec.model_fields.items() if f.annotation is RangedQuantity]
        assert tuple(keys) == law.keys
        assert spec.law is law
