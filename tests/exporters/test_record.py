"""The record as a model: its numbers agree, and it keeps its published schema."""

import json
import struct
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from pydantic import ValidationError

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.exporters.export import Execution, export_design
from nrs_design.exporters.record import ExportRecord, Gain, dump_record, record_schema_text
from nrs_design.spec import read_spec
from tests.tables import rows

SPECS = Path(__file__).parents[2] / "specs"


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_three_forms_of_a_gain_are_the_same_number(value):
    bits = struct.pack(">f", value).hex()
    exact = exact_decimal(Fraction(value))
    gain = Gain(name="Kp", unit="rpm/rad", exact=exact, float32=value, float32_bits=f"0x{bits}")
    back = json.loads(gain.model_dump_json())["float32"]
    assert struct.pack(">f", back).hex() == bits
    assert Fraction(exact) == Fraction(value)


@pytest.mark.parametrize("change", rows(__file__, "test_forms_that_differ_are_refused"))
def test_forms_that_differ_are_refused(change):
    good = {"name": "k", "unit": "1", "exact": "0.5", "float32": 0.5, "float32_bits": "0x3f000000"}
    assert Gain(**good).exact == "0.5"
    with pytest.raises(ValidationError):
        Gain.model_validate({**good, **change})


def test_json_is_the_dump_of_the_record(record):
    text = dump_record(record)
    assert ExportRecord.model_validate_json(text) == record
    assert dump_record(ExportRecord.model_validate_json(text)) == text
    assert text.isascii()
    document = json.loads(text, parse_constant=pytest.fail)
    assert document["schema"] == "nrs-design/export/1"


def test_every_record_keeps_the_published_schema(record, sampled_export, continuous):
    schema = json.loads(record_schema_text())
    Draft202012Validator.check_schema(schema)
    offset = export_design(read_spec(SPECS / "neuroboscope/force-limit-offset.nrs.yaml"))
    execution = Execution(Fraction(2, 1000), unproved=True)
    unproved = export_design(continuous, execution=execution)
    for one in (record, offset.record, sampled_export.record, unproved.record):
        Draft202012Validator(schema).validate(json.loads(dump_record(one)))


@pytest.mark.parametrize(
    "change", rows(__file__, "test_the_schema_refuses_what_the_record_refuses")
)
def test_the_schema_refuses_what_the_record_refuses(record, change):
    document = {**json.loads(dump_record(record)), **change}
    assert not Draft202012Validator(json.loads(record_schema_text())).is_valid(document)
    with pytest.raises(ValidationError):
        ExportRecord.model_validate_json(json.dumps(document))


@pytest.mark.parametrize(
    "change", [{"unproved": "why"}, {"verdict": "unproved"}, {"proof": None}], ids=str
)
def test_a_verdict_needs_its_proof_or_its_reason(record, change):
    document = {**json.loads(dump_record(record)), **change}
    with pytest.raises(ValidationError, match="verdict"):
        ExportRecord.model_validate_json(json.dumps(document))
