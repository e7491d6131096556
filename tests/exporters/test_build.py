"""A design and its proof, put together."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from nrs_design.certificates.catalogue import sentences
from nrs_design.controllers.float32 import exact_decimal
from nrs_design.controllers.shipped import shipped_law
from nrs_design.errors import CertificateError
from nrs_design.exporters.build import build_record
from nrs_design.exporters.export import export_design
from nrs_design.pipeline.runs import run_certification
from nrs_design.spec import LoadedSpec, parse_spec, read_spec
from tests.support import ROOT, words_of

SPECS = ROOT / "specs"


def test_the_same_motor_in_volts(continuous_export):
    """256 rpm for a volt: the loop is the same to the last digit, and only the gains are others."""
    text = (SPECS / "neuroboscope/soft-tissue.nrs.yaml").read_text()
    text = text.replace("gain: 4.8417e-4 rad/s/rpm", "gain: 0.123947520 rad/s/V\n  command: V")
    text = text.replace("2060 rpm*s/rad", "8046.875 mV*s/rad")
    found = run_certification(
        LoadedSpec(path=Path("volts.nrs.yaml"), sha256=64 * "0", text=text, spec=parse_spec(text))
    )
    system, before = found.certificate.system, continuous_export.certificate.system
    assert [mode.A for mode in system.modes] == [mode.A for mode in before.modes]
    assert set(words_of(system)) - set(words_of(before)) == {
        "The motor takes commands in V: Kp of the motion controller is in V/rad, Kd in V*s/rad."
    }
    Kp, Kd = build_record(found.design, found.certificate, found.designed.spec).motion.gains
    assert (Kd.name, Kd.exact, Kd.unit) == ("Kd", "8.046875", "V*s/rad")
    assert (Kp.exact, Kp.unit) == (exact_decimal(Fraction(117359.4375) / 256), "V/rad")
    limited = text.replace("bandwidth: 2 Hz", "bandwidth: 2 Hz\n  command: 12 V")
    for spec, unit in ((parse_spec(limited), "V"), (continuous_export.spec, "rpm")):
        design = found.design if unit == "V" else continuous_export.design
        law = shipped_law(spec, design, Fraction(1, 500))
        assert law.units == {"command": unit}
        assert {law.coefficient[name].unit for name in ("Kp", "Kd_over_T")} == {f"{unit}/rad"}
        assert law.coefficient["b"].unit == "rad/(s*N*m)"
        if unit == "V":
            limit = law.coefficient["command_limit"]
            assert (limit.unit, limit.values) == ("V", (12,))


def test_proof_is_that_of_the_certificate(record, continuous_export):
    proof = record.proof
    assert proof.certificate_id == continuous_export.certificate.id
    assert proof.assumptions == sentences(continuous_export.certificate.granted)
    assert Fraction(proof.decay_rate.exact) == continuous_export.certificate.evidence.rate
    assert Fraction(proof.decay_rate.rounded) <= continuous_export.certificate.evidence.rate
    assert proof.coordinates == "deflection"


def test_the_rate_of_a_sampled_proof_is_one_per_step(sampled_export):
    """A factor per step holds for every larger one: it is rounded up."""
    rate = sampled_export.record.proof.decay_rate
    assert rate.unit == "1 per step"
    assert 0.9 < Fraction(rate.exact) <= Fraction(rate.rounded) < 1


def test_certificate_of_other_gains_is_refused(continuous_export):
    design, certificate = continuous_export.design, continuous_export.certificate
    gains = {**certificate.gains, "insertion": {"Mt": "0.5", "Bt": "2"}}
    with pytest.raises(CertificateError, match="other gains of insertion"):
        build_record(design, replace(certificate, gains=gains), continuous_export.spec)
    fewer = {"motion": certificate.gains["motion"]}
    with pytest.raises(CertificateError, match="other gains"):
        build_record(design, replace(certificate, gains=fewer), continuous_export.spec)


def test_certificate_that_refutes_is_refused(continuous_export):
    from nrs_design.proof.evidence.growing_sequence import staying

    refuting = replace(continuous_export.certificate, statements=(staying("insertion"),))
    with pytest.raises(CertificateError, match="does not prove stability"):
        build_record(continuous_export.design, refuting, continuous_export.spec)


def test_idle_states_are_exported_as_they_are_proved():
    """0.1 is no single-precision number: the robot and the proof hold the one next to it."""
    loaded = read_spec(SPECS.parent / "docs/examples/mixed-controllers.nrs.yaml")
    text = loaded.text.replace("decay: 20 1/s", "decay: 0.1 1/s, reset: false")
    record = export_design(replace(loaded, spec=parse_spec(text))).record
    idle = record.idle_states
    assert not idle.reset
    assert (idle.decay.name, idle.decay.unit) == ("decay", "1/s")
    assert idle.decay.float32_bits == "0x3dcccccd"
    assert f"decay at {idle.decay.exact} 1/s" in " ".join(record.proof.assumptions)


def test_a_proof_without_rounding_says_so(sampled_export):
    certificate, design = sampled_export.certificate, sampled_export.design
    assert certificate.evidence.covers_rounding
    assert not [text for text in sampled_export.record.outside if "Rounding" in text]
    kept = [item for item in certificate.evidence.multipliers if "rounding" not in item.fact]
    bare = replace(certificate.evidence, multipliers=tuple(kept))
    found = build_record(design, replace(certificate, statements=(bare,)), sampled_export.spec)
    assert found.outside[0].startswith("Rounding: the proof is about the law computed without it")
