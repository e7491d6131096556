"""Sizes that no robot has, and the likely slip."""

import pytest

from nrs_design.certificates.catalogue import sentences
from nrs_design.errors import SpecError
from nrs_design.loop.assumptions import assume_data
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import doubt_spec, parse_spec, read_spec
from nrs_design.spec.describe import describe
from nrs_design.spec.plausible import doubt_size, doubt_sizes, size_of, sizes
from nrs_design.spec.units import parse_unit
from tests.spec.samples import IMPEDANCE, spoiled
from tests.support import ROOT, SOFT_TISSUE

SHIPPED = sorted((ROOT / "specs").rglob("*.nrs.yaml"))


def test_slips_measure_what_their_row_measures():
    for size in sizes():
        for slip in size.slips:
            assert parse_unit(slip).dimension == parse_unit(size.unit).dimension
        assert 0 < size.low < size.high


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_no_shipped_spec_is_asked(path):
    assert list(doubt_sizes(read_spec(path).spec)) == []


@pytest.mark.parametrize(
    ("field", "value", "unit", "said"),
    [
        ("lever_arm", 240.0, "m", "did you mean 240 mm?"),
        ("lever_arm", 24.0, "m", "did you mean 24 mm or 24 cm?"),
        ("lever_arm", 0.00024, "m", "2e-03"),
        ("time_constant", 35.1, "s", "did you mean 35.1 ms?"),
        ("period", 2.0, "s", "did you mean 2 ms?"),
        ("load_inertia", 1213.0, "kg*m^2", "did you mean 1213 g*m^2 or 1213 kg*cm^2?"),
        ("stiffness", 7.5e8, "N/m", "1e+07 N/m is usual"),
        ("mass", 797.0, "kg", "did you mean 797 g?"),
        ("torque", 3e4, "N*m", "did you mean 3e+04 mN*m or 3e+04 N*mm?"),
        ("velocity", 60.0, "rad/s", "did you mean 60 deg/s"),
        ("gravity", 9810.0, "m/s^2", "did you mean 9810 mm/s^2"),
    ],
)
def test_the_likely_slip(field, value, unit, said):
    if said == "2e-03":
        said = "0.002 m to 2 m is usual"
    assert said in doubt_size(field, value, unit)


@pytest.mark.parametrize(
    ("field", "value", "unit"),
    [
        ("stiffness", 10.0, "N/m"),  # brain under a spatula
        ("stiffness", 1e6, "N/m"),  # bone
        ("stiffness", 0.233, "N*m/rad"),  # thesis table 2.4
        ("lever_arm", 1.3, "m"),  # a large arm
        ("load_inertia", 30.0, "kg*m^2"),
        ("torque", 300.0, "N*m"),
        ("time_constant", 0.0005, "s"),
        ("period", 2.5e-5, "s"),
        ("mass", 30.0, "kg"),
        ("velocity", 3.9, "rad/s"),
        ("age", 0.3, "s"),
        ("damping", 0.0, "N*s/m"),
    ],
)
def test_what_surgical_and_coworker_robots_have_is_not_asked(field, value, unit):
    assert doubt_size(field, value, unit) is None


def test_every_quantity_of_the_shipped_specs_has_a_row():
    missing = set()
    for path in SHIPPED:
        for row in describe(read_spec(path).spec):
            if row.unit and row.written[:1].isdigit() and row.unit not in ("samples", "steps"):
                field = row.name.rpartition(".")[2].partition("[")[0]
                if size_of(field, parse_unit(row.unit).dimension) is None:
                    missing.add((row.name, row.unit))
    assert missing == set()


LONG = spoiled(IMPEDANCE, "lever_arm: 0.24 m", "lever_arm: 240 m")
REASON = "    accept_doubt: a crane, not a robot\n"


def test_a_size_is_accepted_with_a_reason_which_every_proof_prints():
    at = ("environments", "soft", "lever_arm")
    assert at in [doubt.at for doubt in doubt_spec(parse_spec(LONG))]
    accepted = LONG.replace("    lever_arm: 240 m\n", f"    lever_arm: 240 m\n{REASON}")
    spec = parse_spec(accepted)
    assert at not in [doubt.at for doubt in doubt_spec(spec)]
    (said,) = (text for text in sentences(assume_data(spec)) if "crane" in text)
    assert "Sizes of soft are unusual: lever_arm is 240 m; accepted because: a crane" in said
    # A reason for what the identification left in doubt is none for a size.
    both = accepted.replace(REASON, f"    doubts: [short]\n{REASON}")
    assert at in [doubt.at for doubt in doubt_spec(parse_spec(both))]
    with pytest.raises(SpecError, match="there are no doubts to accept"):
        parse_spec(accepted.replace("240 m", "0.24 m"))


def test_a_slip_goes_before_advice_on_gains(tmp_path):
    path = tmp_path / "slip.nrs.yaml"
    path.write_text(SOFT_TISSUE.read_text().replace("lever_arm: 0.24 m", "lever_arm: 240 m"))
    with pytest.raises(Exception, match="keeps the loop stable") as caught:
        run_design(read_spec(path))
    assert caught.value.remedy.startswith("first, line ")
    assert "did you mean 240 mm? Otherwise, raise the upper bound of Bt" in caught.value.remedy
