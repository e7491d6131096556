"""`nrs-design audit`, as a user types it."""

import re
import shutil

import numpy as np
import pytest

from tests.identification import runs
from tests.support import ROOT, SOFT_TISSUE, document_of, run


@pytest.fixture(scope="module")
def proof(tmp_path_factory):
    folder = tmp_path_factory.mktemp("proof")
    spec = folder / "soft-tissue.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    certificate = folder / "soft-tissue.cert.json"
    run("certify-switching", spec, "--out", certificate, cwd=folder, code=0)
    return spec, certificate


def write(tmp_path, **options):
    path = tmp_path / "run.csv"
    path.write_text(runs.text(*runs.run(**options)))
    return path


def without_command(tmp_path):
    path = write(tmp_path)
    t, angle, torque, _, mode = runs.run()
    # A motor that follows its command 1 sample later, so that the delay can be told.
    command = np.append(angle[1:], angle[-1]) * 1e5
    path.write_text(runs.text(t, angle, torque, command, mode))
    return path


@pytest.mark.slow
def test_a_good_run_is_not_inside_as_its_stiffness_is_not_judged(tmp_path, proof):
    spec, certificate = proof
    given = ("--certificate", certificate, "-v")
    done = run("audit", without_command(tmp_path), spec, *given, cwd=tmp_path, code=3)
    assert "INCONCLUSIVE: no bound was left as far as could be judged" in done.stdout
    assert "stiffness: not judged: the spec has no `monitoring`" in done.stdout
    assert "bound of delay, jitter: taken for granted by the proof" in done.stdout
    assert "UNPROVED" not in done.stdout


def test_the_stiffness_is_tested_where_readings_are_known(tmp_path):
    """Half a stiffness from 6 s on."""
    spec = tmp_path / "soft-tissue.nrs.yaml"
    text = SOFT_TISSUE.read_text()
    log = write(tmp_path, stiffness=lambda t: np.where(t > 6, 21.5, runs.STIFFNESS))
    said = "{torque_noise: 3 N*mm, angle_noise: 1e-5 rad, surface: fixed}"
    spec.write_text(f"{text}\ncontact: losable\nmonitoring: {said}\n")
    document = document_of("audit", log, spec, cwd=tmp_path, code=1)
    first = document["first_violation"]
    assert first["check"] == "stiffness"
    assert 6.0 < first["time_s"] < 6.2
    assert 0.55 < document["judged_share_of_rows"] < 0.601


def test_an_unproved_spec_is_said_loudly(tmp_path):
    done = run("audit", write(tmp_path), SOFT_TISSUE, "-v", cwd=tmp_path, code=3)
    assert "UNPROVED SPEC: no certificate is named" in done.stdout
    assert done.stdout.count("where the driver saturates is not known") == 1
    assert "saturation: not judged" in done.stdout


def test_without_a_certificate_nothing_speaks_of_a_proof(tmp_path):
    """Not in the text, not in JSON: only that the spec is not proved."""
    log = write(tmp_path)
    done = run("audit", log, SOFT_TISSUE, "-v", cwd=tmp_path)
    document = run("audit", log, SOFT_TISSUE, "--json", "-v", cwd=tmp_path).stdout
    for text in (done.stdout, document):
        assert "the spec, which is not proved" in text
        assert re.search(r"\bproof|covered by|stayed inside what was proved", text) is None


def test_a_foreign_certificate_is_rejected(tmp_path, proof):
    _, certificate = proof
    other = ROOT / "specs/neuroboscope/soft-tissue-redesigned.nrs.yaml"
    done = run("audit", write(tmp_path), other, "--certificate", certificate, cwd=tmp_path, code=2)
    assert "the certificate is rejected: it belongs to another spec" in done.stderr
