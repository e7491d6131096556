"""Sizes that no robot has, and the likely slip."""

import pytest

from nrs_design.certificates.catalogue import sentences
from nrs_design.errors import SpecError
from nrs_design.loop.assumptions import assume_data
from nrs_design.spec import doubt_spec, parse_spec, read_spec
from nrs_design.spec.describe import describe
from nrs_design.spec.plausible import doubt_size, doubt_sizes, size_of, sizes
from nrs_design.spec.units import parse_unit
from tests.spec.samples import IMPEDANCE, spoiled
from tests.support import ROOT
from tests.tables import rows

SHIPPED = sorted((ROOT / "specs").rglob("*.nrs.yaml"))


def test_slips_measure_what_their_row_measures():
    for size in sizes():
        for slip in size.slips:
            assert parse_unit(slip).dimension == parse_unit(size.unit).dimension
        assert 0 < size.low < size.high


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_no_shipped_spec_is_asked(path):
    assert list(doubt_sizes(read_spec(path).spec)) == []


@pytest.mark.parametrize(("field", "value", "unit", "said"), rows(__file__, "test_the_likely_slip"))
def test_the_likely_slip(field, value, unit, said):
    assert said in doubt_size(field, value, unit)


@pytest.mark.parametrize(
    ("field", "value", "unit"),
    rows(__file__, "test_what_surgical_and_coworker_robots_have_is_not_asked"),
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
