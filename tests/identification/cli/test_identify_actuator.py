"""`nrs-design identify actuator`, as a user types it."""

import json
import shutil

import pytest

from tests.identification.cli.records import DATA, SINUSOIDS
from tests.support import SOFT_TISSUE, run


@pytest.mark.slow
def test_sinusoids_and_a_ready_response(tmp_path):
    spec = tmp_path / "copy.nrs.yaml"
    shutil.copy(SOFT_TISSUE, spec)
    arguments = ("identify", "actuator", *SINUSOIDS, "--json", "--write", spec)
    assert json.loads(run(*arguments, cwd=tmp_path, code=0).stdout)["range_covers"] == "confidence"
    assert "gain: {nominal: 4.84" in spec.read_text()
    assert "range_covers: confidence" in spec.read_text()
    text = run("identify", "actuator", DATA / "actuator-response.csv", "-v", cwd=tmp_path).stdout
    assert text.startswith("SYNTHETIC data")
    assert "ready frequency response" in text
