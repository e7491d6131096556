"""What a release has promised stays: see docs/stable.md."""

import shutil

import pytest

from tests.stable import RELEASED, promises
from tests.support import ROOT, run

# As release 1.0 wrote them, with their specs.
WRITTEN = ROOT / "tests" / "data" / "release-1.0"


def test_nothing_that_was_released_is_gone():
    released = RELEASED.read_text(encoding="utf-8").splitlines()
    assert len(released) > 500
    assert sorted(set(released) - set(promises())) == []


@pytest.mark.parametrize("name", ["soft-tissue", "failing-controller"])
def test_certificates_of_a_release_still_hold(tmp_path, name):
    spec, certificate = WRITTEN / f"{name}.nrs.yaml", WRITTEN / f"{name}.cert.json"
    run("verify", certificate, spec, cwd=tmp_path, code=0)


def test_a_lock_file_of_a_release_still_gates(tmp_path):
    shutil.copytree(WRITTEN, tmp_path / "kept")
    run("gate", ".", "--locked", cwd=tmp_path / "kept", code=0)
