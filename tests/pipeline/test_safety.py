"""A safety layer from the spec to the statement, the page, the C and a run."""

import json
import re
from dataclasses import replace

import pytest

from nrs_design.certificates.certificate import dump
from nrs_design.certificates.verify import verify_document
from nrs_design.errors import SpecError
from nrs_design.pipeline import run_certification, run_design
from nrs_design.pipeline.certification import assemble_spec
from nrs_design.proof.evidence import Shows
from nrs_design.proof.evidence.fields import read_ratio
from nrs_design.spec import parse_spec, read_spec
from tests.simulation.interactions import simulated
from tests.support import run

LAYER = """\
disturbances: {largest_angle: 3 rad}
safety:
  speed: 10 deg/s
  torque: 0.3 N*m
  energy: 5 mJ
  power: 1 mW
  stiffness: [30 N*m/rad, 60 N*m/rad]
"""
TEXT = f"""\
kind: interaction-design
name: guarded
actuator: {{gain: 4.8417e-4 rad/s/rpm, time_constant: 0.0351 s}}
motion_loop: {{damping_ratio: 0.707, settling_time: 0.1404 s}}
limits: {{velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz, command: 10000 rpm}}
environments:
  soft: {{model: elastic, stiffness: 43 N*m/rad}}
controllers:
  slow: {{type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad}}
contact: kept
switching: arbitrary
sampling: {{period: 2 ms, delay: 1}}
{LAYER}"""


@pytest.fixture(scope="module")
def loaded(tmp_path_factory):
    file = tmp_path_factory.mktemp("safe") / "guarded.nrs.yaml"
    file.write_text(TEXT, encoding="utf-8")
    return read_spec(file)


@pytest.fixture(scope="module")
def result(loaded):
    return run_certification(loaded)


def statement(result):
    (found,) = (s for s in result.certification.statements if s.shows is Shows.SAFETY)
    return found


def test_the_certificate_holds_stability_and_what_the_layer_keeps(loaded, result):
    certificate = result.certificate
    assert certificate.verdict == "proved"
    kept = statement(result)
    assert 0.17 < float(kept.limits.velocity) < 0.22
    assert 0.6 < float(kept.limits.steady) < float(kept.limits.torque) < 1
    assert any("safety layer is idle" in text for text in certificate.granted)
    document = json.loads(dump(certificate))
    assert verify_document(document, loaded)
    # Another layer is another spec, and another system.
    altered = json.loads(dump(certificate))
    altered["safety"]["torque"] = str(read_ratio(altered["safety"]["torque"]) / 2)
    assert not verify_document(altered)


def test_without_the_layer_the_modes_are_the_same(loaded, result):
    bare = parse_spec(TEXT.replace(LAYER, "disturbances: {largest_angle: 3 rad}\n"))
    other = replace(loaded, spec=bare)
    without = assemble_spec(other, run_design(other))
    system = result.certification.system
    assert system.safety is not None
    assert without.safety is None
    assert system.modes == without.modes


def test_where_stability_is_refuted_the_layer_keeps_its_limits_all_the_same(loaded):
    wild = parse_spec(TEXT.replace("Bt: 2.15", "Bt: 0.05"))
    result = run_certification(replace(loaded, spec=wild))
    assert result.certificate.verdict == "refuted"
    assert statement(result).find_fault(result.certification.system) is None


def test_a_driver_that_could_saturate_has_no_statement_and_it_is_said(loaded, tmp_path):
    file = tmp_path / "small.nrs.yaml"
    file.write_text(TEXT.replace("10000 rpm", "500 rpm"), encoding="utf-8")
    text = run("certify-switching", file, "--out", "c.json", cwd=tmp_path, code=0).stdout
    assert "limits of the safety layer: a candidate was found, but the command of the motor" in text


def test_the_command_line_prints_one_line_and_exports_the_layer(tmp_path):
    file, proof = tmp_path / "guarded.nrs.yaml", tmp_path / "guarded.json"
    file.write_text(TEXT, encoding="utf-8")
    text = run("certify-switching", file, "--out", proof, cwd=tmp_path, code=0).stdout
    (line,) = (line for line in text.splitlines() if "Safety layer, whatever" in line)
    assert "the command of the motor is at most" in line
    run("verify", proof, file, cwd=tmp_path, code=0)
    out = tmp_path / "c"
    made = ("--certificate", proof, "--format", "c", "--out", out)
    run("export", file, *made, cwd=tmp_path, code=0)
    header, source = ((out / f"guarded.{end}").read_text() for end in ("h", "c"))
    assert "claim: Safety layer, whatever" in " ".join(header.replace(" *", "").split())
    assert "float withheld; /* rad */" in header
    assert "(left >= 0.0F) ? allowed : 0.0F" in source
    deployed = ("verify", proof, file, "--deployed", out / "guarded.h")
    run(*deployed, cwd=tmp_path, code=0)
    macro = re.search(r"#define NRS_GUARDED_SAFE_TORQUE (\S+)", header)
    (out / "guarded.h").write_text(header.replace(macro[1], "0.5F"))
    assert "SAFE_TORQUE" in run(*deployed, cwd=tmp_path, code=1).stdout


def test_a_run_of_the_spec_is_that_of_the_layer(result):
    """The hand presses at its limit: the law moves on, the layer stops it at its torque."""
    pressed = "command: {points: [[0 s, 8 deg/s], [2 s, 8 deg/s]]}, surfaces: [{environment: soft, "
    text = f"{TEXT}scenarios:\n  run: {{{pressed}at: 0.5 deg}}]}}\n"
    response = simulated(text, "sampled").response
    most = statement(result).limits
    assert abs(response["torque"]).max() <= float(most.steady)
    assert abs(response["velocity"]).max() <= float(most.velocity)
    assert 0 < response["spent"].max() <= 0.005


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("disturbances: {largest_angle: 3 rad}\n", "", "depends on the rounding of angles"),
        ("[30 N*m/rad, 60 N*m/rad]", "[50 N*m/rad, 60 N*m/rad]", "'soft' is touched"),
        ("[30 N*m/rad, 60 N*m/rad]", "[60 N*m/rad, 30 N*m/rad]", "below its start"),
        ("elastic, stiffness: 43 N*m/rad", "kelvin-voigt, stiffness: 43 N*m/rad, damping: "
         "1 N*m*s/rad", "damping is not within"),
        ("time_constant: 0.0351 s", "time_constant: 0.0351 s, load_inertia: 1 kg*m^2",
         "a load of the motor"),
        ("period: 2 ms, delay: 1", "period: 2 ms, delay: 1, outer_period: 4 ms", "outer_period"),
        ("type: impedance, environment: soft, Mt: 0 kg*m^2, Bt: 2.15 N*m*s/rad",
         "type: force, environment: soft, proportional_gain: 0.02 rad/(N*m)",
         "no impedance controller"),
        ("sampling: {period: 2 ms, delay: 1}\n", "", "continuous time"),
        ("energy: 5 mJ", "energy: 5 mN", "an energy"),
    ],
)  # fmt: skip
def test_what_it_is_not_for_is_refused(old, new, words):
    assert old in TEXT
    with pytest.raises(SpecError) as caught:
        parse_spec(TEXT.replace(old, new))
    assert any(words in fault.message for fault in caught.value.faults)
