"""`nrs-design identify`, as a user types it."""

import json
import shutil

import pytest

from nrs_design.models.contact import Elastic, KelvinVoigt
from nrs_design.spec import read_spec
from tests.identification import signals
from tests.identification.support import NOSE, SINUSOIDS, SOFT, quick, record, write_csv
from tests.support import ROBOT, SOFT_TISSUE, document_of, run


@pytest.mark.slow
def test_sinusoids_into_a_spec(tmp_path):
    spec = tmp_path / "copy.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    arguments = ("identify", "actuator", *SINUSOIDS, "--json", "--write", spec)
    assert json.loads(run(*arguments, cwd=tmp_path, code=0).stdout)["range_covers"] == "confidence"
    assert "gain: {nominal: 4.84" in spec.read_text()
    assert "range_covers: confidence" in spec.read_text()


DELAY = ("identify", "delay", "loop.csv", "--command", "raw", "--measured", "used")


def write_loop(folder, time, raw, used):
    write_csv(folder / "loop.csv", "time_s,raw,used", time, raw, used)


@pytest.mark.slow
def test_delay_into_a_spec(tmp_path):
    spec = tmp_path / "mine.nrs.yaml"
    shutil.copy(ROBOT / "soft-tissue-sampled.nrs.yaml", spec)
    record = signals.copy(1)
    write_loop(tmp_path, record.time, record.command, record.output)
    options = ("--report", "delay.html", "--write", spec)
    document = document_of(*DELAY, *options, cwd=tmp_path, code=0)
    samples = document["delay_samples"]
    assert samples["low"] < signals.DELAY < samples["high"]
    assert document["sampling_step_s"] == pytest.approx(0.002)
    assert document["whole_samples"][1] >= 3
    assert (tmp_path / "delay.html").exists()
    assert "delay: [1, 4]" in spec.read_text()


def test_a_doubt_is_no_success(tmp_path):
    """Of columns that are swapped, the exit code was 0, and the text said "-0.01 s later"."""
    record = signals.copy(4)
    write_loop(tmp_path, record.time, record.output, record.command)
    done = run(*DELAY, cwd=tmp_path, code=3)
    assert "s earlier (correlation" in done.stdout
    assert "samples of 0.002 s [95 %]" in done.stdout
    assert "warning: used comes 6.23 samples before raw" in done.stderr


def test_end_to_end(tmp_path):
    """Shipped records into a copy of the soft-tissue spec; the gate proves the whole interval."""
    spec = tmp_path / "soft-tissue.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    document = document_of("identify", "tissue", *SOFT, "--write", spec, cwd=tmp_path, code=0)
    assert document["schema"] == "nrs-design/identify-tissue/1"
    assert document["synthetic"] is True
    assert document["chosen"] == "elastic"
    k = document["ranges"]["k"]
    # Thesis 6.1: three fits and their mean, 747.14 N/m.
    assert all(k["low"] < fit < k["high"] for fit in (768.17, 720.56, 752.69))
    assert k["value"] == pytest.approx(747.14, rel=5e-3)
    assert "data: synthetic" in spec.read_text()
    run("gate", spec, "--json", "--no-reports", "-v", cwd=tmp_path, code=0)
    check = run("check", spec, "-v", cwd=tmp_path).stdout
    assert "silicone-soft-1.csv" in check
    assert "synthetic" in check


def test_writing_a_law_that_fits_worse_warns(tmp_path):
    spec = tmp_path / "copy.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    arguments = ("identify", "tissue", NOSE[0], "--model", "elastic", "--write", spec, "-q")
    first, *doubts = run(*arguments, cwd=tmp_path, code=3).stderr.splitlines()
    assert first.startswith("warning: kelvin-boltzmann describes the records better than elastic")
    assert any("the residual is" in doubt for doubt in doubts)
    assert "NRS107 missed" in run("gate", spec, "--no-reports", cwd=tmp_path, code=1).stdout


def press_csv(folder, data, scales=(1.0, 1.0)):
    """Write a record, whose deflection and force may be in another unit."""
    columns = (data.motion.time, scales[0] * data.motion.deflection, scales[1] * data.force)
    return write_csv(folder / "press.csv", "time_s,deflection_m,force_N", *columns)


VOIGT = ("    model: elastic\n", "    model: kelvin-voigt\n    damping: 30 N*s/m\n")


def damped_csv(folder, b=30.0):
    law = KelvinVoigt(400.0, b) if b else Elastic(400.0)
    return press_csv(folder, record(law, quick(1), 0.02, 1))


def test_the_law_of_the_spec_is_kept_unless_another_is_asked_for(tmp_path):
    spec = tmp_path / "copy.nrs.yaml"
    spec.write_text(SOFT_TISSUE.read_text().replace(*VOIGT))
    arguments = ("identify", "tissue", damped_csv(tmp_path), "--write", spec)
    kept = run(*arguments, "-q", cwd=tmp_path, code=3)
    assert kept.stderr.startswith(
        "warning: stiffness: the range from 1 record is 27.8 times narrow"
    )
    spec.write_text(SOFT_TISSUE.read_text().replace(*VOIGT))
    kept = run(*arguments, cwd=tmp_path, code=3)
    assert "kelvin-voigt is the law of the spec, which is kept" in kept.stdout
    assert "the gate fails on its doubts until accept_doubt says why" in kept.stderr
    assert "NRS107 missed" in run("gate", spec, "--no-reports", cwd=tmp_path, code=1).stdout
    assert "changed: environments.soft.damping: 30 N*s/m -> 29." in kept.stderr
    assert "no longer there" not in kept.stderr
    soft = read_spec(spec).spec.environments["soft"]
    assert soft.doubts[0].startswith("stiffness: the range from 1 record is 27.8 times narrower")
    assert soft.model == "kelvin-voigt"
    assert soft.damping.range[0].si < 30 < soft.damping.range[1].si
    told = run(*arguments, "--model", "elastic", "-q", cwd=tmp_path, code=3)
    assert "warning: no longer there: environments.soft.damping: 29." in told.stderr
    assert "warning: kelvin-voigt describes the records better than elastic" in told.stderr


def test_a_law_that_is_not_refused_before_the_fit_does_not_lose_it(tmp_path):
    """Records of a spring do not tell the damper of the spec: what was found is printed."""
    spec, text = tmp_path / "copy.nrs.yaml", SOFT_TISSUE.read_text().replace(*VOIGT)
    spec.write_text(text)
    record_, options = damped_csv(tmp_path, b=0.0), ("--set", "contact=given")
    arguments = ("identify", "tissue", record_, *options, "--write", spec)
    result = run(*arguments, "-v", cwd=tmp_path, code=2)
    assert "BIC - least" in result.stdout
    assert "choose a simpler law with --model" in result.stderr
    assert spec.read_text() == text
    document = document_of(*arguments, cwd=tmp_path)
    assert document["chosen"] == "kelvin-voigt"
    assert "unlimited" in str(document["not_written"])


def test_what_cannot_be_written_is_refused(tmp_path):
    sent = tmp_path / "link.nrs.yaml"
    sent.symlink_to(SOFT_TISSUE)
    path = damped_csv(tmp_path)
    for spec, said, *options in (
        (sent, "link"),
        (ROBOT / "nose.nrs.yaml", "has no lever_arm"),
        (SOFT_TISSUE, "has no place", "--model", "hunt-crossley"),
    ):
        done = run("identify", "tissue", path, "--write", spec, *options, cwd=tmp_path, code=2)
        assert said in done.stderr


@pytest.mark.parametrize(
    ("scales", "said"),
    [
        ((1.0, 1e-3), "the force spans 0.00265 N: is that its unit? did you mean 0.00265 kN?"),
        pytest.param(
            (1e3, 1.0), "the deflection spans 6.61 m: is that its unit?", marks=pytest.mark.slow
        ),
        ((1.0, -1.0), "force and deflection have opposite signs"),
    ],
)
def test_another_unit_or_sign_is_no_success(tmp_path, scales, said):
    """Each has a doubt, the exit code, and the gate."""
    spec = tmp_path / "copy.nrs.yaml"
    path = press_csv(tmp_path, record(KelvinVoigt(400.0, 3.0), quick(1), 0.001, 1), scales)
    shutil.copy(SOFT_TISSUE, spec)
    assert f"warning: press: {said}" in run("identify", "tissue", path, cwd=tmp_path, code=3).stderr
    options = ("--write", spec, "--model", "elastic", "-q")
    written = run("identify", "tissue", path, *options, cwd=tmp_path)
    if "signs" in said:
        # No spring pushes that way: its range has no end, and nothing is written.
        assert written.returncode == 2
        assert spec.read_text() == SOFT_TISSUE.read_text()
    else:
        assert written.returncode == 3
        assert any(said in doubt for doubt in read_spec(spec).spec.environments["soft"].doubts)
