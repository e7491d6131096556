import json
import struct
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jsonschema import Draft202012Validator
from pydantic import ValidationError

from nrs_design.controllers.float32 import exact_decimal
from nrs_design.errors import CertificateError, DesignError
from nrs_design.exporters.export import Execution, export_design
from nrs_design.exporters.record import ExportRecord, Gain, build_record, dump_record, schema_text
from nrs_design.pipeline import run_certification
from nrs_design.spec import LoadedSpec, parse_spec, read_spec

SPECS = Path(__file__).parents[2] / "specs"


@pytest.fixture(scope="module")
def result():
    return run_certification(read_spec(SPECS / "neuroboscope/soft-tissue.nrs.yaml"))


@pytest.fixture
def record(result):
    return build_record(result.design, result.certificate, None)


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_three_forms_of_a_gain_are_the_same_number(value):
    bits = struct.pack(">f", value).hex()
    exact = exact_decimal(Fraction(value))
    gain = Gain(name="Kp", unit="rpm/rad", exact=exact, float32=value, float32_bits=f"0x{bits}")
    back = json.loads(gain.model_dump_json())["float32"]
    assert struct.pack(">f", back).hex() == bits
    assert Fraction(exact) == Fraction(value)


@pytest.mark.parametrize(
    "change",
    [
        {"exact": "0.5000001"},
        {"float32": 0.25},
        {"float32": float("inf")},
        {"float32": float("nan")},
        {"float32_bits": "0x3f000001"},
        {"float32_bits": "0x7fc00000"},
        {"float32_bits": "3f000000"},
        {"exact": 0.5},
        {"extra": 1},
    ],
    ids=str,
)
def test_forms_that_differ_are_refused(change):
    good = {"name": "k", "unit": "1", "exact": "0.5", "float32": 0.5, "float32_bits": "0x3f000000"}
    assert Gain(**good).exact == "0.5"
    with pytest.raises(ValidationError):
        Gain.model_validate({**good, **change})


def test_published_gains_as_single_precision_numbers(record):
    """Thesis 6.3.2.1: Mt = 0.01, Bt = 2.15 and 1.04; thesis 4.3: Kd = 2060, Kp = 117359.43."""
    shipped = {
        (controller.name, gain.name): (gain.float32_bits, gain.unit)
        for controller in record.controllers
        for gain in controller.gains
    }
    assert shipped == {
        ("insertion", "Mt"): ("0x3c23d70a", "kg*m^2"),
        ("insertion", "Bt"): ("0x4009999a", "N*m*s/rad"),
        ("withdrawal", "Mt"): ("0x3c23d70a", "kg*m^2"),
        ("withdrawal", "Bt"): ("0x3f851eb8", "N*m*s/rad"),
    }
    Kp, Kd = record.motion.gains
    assert (Kd.name, Kd.exact, Kd.unit) == ("Kd", "2060", "rpm*s/rad")
    assert Kp.float32 == pytest.approx(117359.43, rel=1e-7)


def test_the_same_motor_in_volts(result):
    """256 rpm for a volt: the loop is the same to the last digit, and only the gains are others."""
    text = (SPECS / "neuroboscope/soft-tissue.nrs.yaml").read_text()
    text = text.replace("gain: 4.8417e-4 rad/s/rpm", "gain: 0.123947520 rad/s/V\n  command: V")
    text = text.replace("2060 rpm*s/rad", "8046.875 mV*s/rad")
    found = run_certification(LoadedSpec(Path("volts.nrs.yaml"), 64 * "0", text, parse_spec(text)))
    system, before = found.certificate.system, result.certificate.system
    assert [mode.A for mode in system.modes] == [mode.A for mode in before.modes]
    assert set(system.assumptions) - set(before.assumptions) == {
        "The motor takes commands in V: Kp of the motion controller is in V/rad, Kd in V*s/rad."
    }
    Kp, Kd = build_record(found.design, found.certificate, None).motion.gains
    assert (Kd.name, Kd.exact, Kd.unit) == ("Kd", "8.046875", "V*s/rad")
    assert (Kp.exact, Kp.unit) == (exact_decimal(Fraction(117359.4375) / 256), "V/rad")


def test_proof_is_that_of_the_certificate(record, result):
    proof = record.proof
    assert proof.certificate_id == result.certificate.id
    assert proof.assumptions == result.certificate.system.assumptions
    assert Fraction(proof.decay_rate.exact) == result.certificate.evidence.rate
    assert Fraction(proof.decay_rate.rounded) <= result.certificate.evidence.rate
    assert proof.coordinates == "deflection"


def test_the_rate_of_a_sampled_proof_is_one_per_step():
    """A factor per step holds for every larger one: it is rounded up."""
    text = (SPECS / "neuroboscope/soft-tissue.nrs.yaml").read_text()
    head, _, _ = text.partition("  withdrawal:")
    text = f"{head}switching: arbitrary\nsampling: {{period: 2 ms, delay: 0}}\n"
    found = run_certification(LoadedSpec(Path("late.nrs.yaml"), 64 * "0", text, parse_spec(text)))
    rate = build_record(found.design, found.certificate, None).proof.decay_rate
    assert rate.unit == "1 per step"
    assert 0.9 < Fraction(rate.exact) <= Fraction(rate.rounded) < 1


def test_json_is_the_dump_of_the_record(record):
    text = dump_record(record)
    assert ExportRecord.model_validate_json(text) == record
    assert dump_record(ExportRecord.model_validate_json(text)) == text
    assert json.loads(text)["schema"] == "nrs-design/export/1"


def test_record_is_frozen_and_strict(record):
    with pytest.raises(ValidationError):
        record.spec = None
    document = json.loads(dump_record(record))
    for change in ({"extra": 1}, {"schema": "other"}, {"controllers": []}):
        with pytest.raises(ValidationError):
            ExportRecord.model_validate_json(json.dumps({**document, **change}))
    document["proof"]["verdict"] = "inconclusive"
    with pytest.raises(ValidationError):
        ExportRecord.model_validate_json(json.dumps(document))


def test_certificate_of_other_gains_is_refused(result):
    gains = {**result.certificate.gains, "insertion": {"Mt": "0.5", "Bt": "2"}}
    with pytest.raises(CertificateError, match="other gains of insertion"):
        build_record(result.design, replace(result.certificate, gains=gains), None)
    fewer = {"motion": result.certificate.gains["motion"]}
    with pytest.raises(CertificateError, match="other gains"):
        build_record(result.design, replace(result.certificate, gains=fewer), None)


def test_certificate_that_refutes_is_refused(result):
    from nrs_design.proof.evidence import UnstableMode

    refuting = replace(result.certificate, statements=(UnstableMode("insertion", "1"),))
    with pytest.raises(CertificateError, match="does not prove stability"):
        build_record(result.design, refuting, None)


def test_force_and_position_controllers():
    loaded = read_spec(SPECS / "neuroboscope/force-limit.nrs.yaml")
    record = export_design(loaded).record
    position, force = record.controllers
    assert (position.law, position.gains, position.contacts) == ("position", (), ())
    assert (force.law, force.environment, force.gains[0].unit) == ("force", "soft", "rad/(N*m)")


def test_given_matrices_have_no_gains():
    with pytest.raises(DesignError, match="no gains") as caught:
        export_design(read_spec(SPECS / "examples/commuting.nrs.yaml"))
    assert caught.value.remedy


def test_idle_states_are_exported_as_they_are_proved():
    """0.1 is no single-precision number: the robot and the proof hold the one next to it."""
    text = (SPECS.parent / "docs/examples/mixed-controllers.nrs.yaml").read_text()
    assert "decay: 20 1/s" in text
    spec = parse_spec(text.replace("decay: 20 1/s", "decay: 0.1 1/s, reset: false"))
    loaded = replace(
        read_spec(SPECS.parent / "docs/examples/mixed-controllers.nrs.yaml"), spec=spec
    )
    record = export_design(loaded).record
    assert record is not None
    idle = record.idle_states
    assert idle is not None
    assert not idle.reset
    assert (idle.decay.name, idle.decay.unit) == ("decay", "1/s")
    assert idle.decay.float32_bits == "0x3dcccccd"
    assert f"decay at {idle.decay.exact} 1/s" in " ".join(record.proof.assumptions)


def test_one_kind_of_controller_has_no_idle_states(record):
    assert json.loads(dump_record(record))["idle_states"] is None


def test_offset_is_written_where_force_controllers_have_one():
    """The robot must take X_i as the proof says."""
    record = export_design(read_spec(SPECS / "neuroboscope/force-limit-offset.nrs.yaml")).record
    assert json.loads(dump_record(record))["offset"] == "measured"


def test_without_offset_there_is_none(record):
    assert json.loads(dump_record(record))["offset"] is None


@pytest.mark.parametrize("name", ["soft-tissue", "force-limit", "force-limit-offset"])
def test_every_record_keeps_the_published_schema(name):
    schema = json.loads(schema_text())
    Draft202012Validator.check_schema(schema)
    record = export_design(read_spec(SPECS / f"neuroboscope/{name}.nrs.yaml")).record
    Draft202012Validator(schema).validate(json.loads(dump_record(record)))


def test_the_records_of_programs_keep_the_schema(sampled_export, continuous):
    execution = Execution(Fraction(2, 1000), unproved=True)
    unproved = export_design(continuous, execution=execution).record
    for record in (sampled_export.record, unproved):
        assert record.sample_time is not None
        Draft202012Validator(json.loads(schema_text())).validate(json.loads(dump_record(record)))


@pytest.mark.parametrize(
    "change",
    [
        {"extra": 1},
        {"schema": "nrs-design/export/2"},
        {"controllers": []},
        {"verdict": "refuted"},
        {"sample_time": 0.002},
        {"delay": [0, 1, 2]},
        {"spec": {"name": "x", "sha256": "0"}},
    ],
    ids=str,
)
def test_the_schema_refuses_what_the_record_refuses(record, change):
    document = {**json.loads(dump_record(record)), **change}
    assert not Draft202012Validator(json.loads(schema_text())).is_valid(document)
    with pytest.raises(ValidationError):
        ExportRecord.model_validate_json(json.dumps(document))


@pytest.mark.parametrize(
    "change", [{"unproved": "why"}, {"verdict": "unproved"}, {"proof": None}], ids=str
)
def test_a_verdict_needs_its_proof_or_its_reason(record, change):
    document = {**json.loads(dump_record(record)), **change}
    with pytest.raises(ValidationError, match="verdict"):
        ExportRecord.model_validate_json(json.dumps(document))
