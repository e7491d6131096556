"""Certificates of what an older release proved and this one does not: none of them holds."""

import pytest

from nrs_design.errors import SpecError
from nrs_design.spec import read_spec
from tests.support import ROOT, run

# Axes that act on each other, as release 1.0 wrote them.
AXES = ROOT / "tests/data/coupled-axes"
CERTIFICATE, SPEC = AXES / "soft-tissue-axes.cert.json", AXES / "soft-tissue-axes.nrs.yaml"


def test_coupled_axes_are_rejected_without_a_spec(tmp_path):
    done = run("verify", CERTIFICATE, cwd=tmp_path, code=1)
    assert "REJECTED: its schema is not nrs-design/certificate/9" in done.stdout


def test_their_spec_is_refused(tmp_path):
    with pytest.raises(SpecError, match="unknown key `coupling`"):
        read_spec(SPEC)
    run("verify", CERTIFICATE, SPEC, cwd=tmp_path, code=2)
