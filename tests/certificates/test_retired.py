"""Certificates of what an older release proved and this one does not: none of them holds."""

import copy
import json
import runpy
import sys

import pytest

from nrs_design.certificates.certificate import content_id
from nrs_design.certificates.prove import prove
from nrs_design.errors import SpecError
from nrs_design.spec import read_spec
from tests.support import ROOT, run

# Axes that act on each other, as release 1.0 wrote them.
AXES = ROOT / "tests/data/coupled-axes"
CERTIFICATE, SPEC = AXES / "soft-tissue-axes.cert.json", AXES / "soft-tissue-axes.nrs.yaml"


def test_coupled_axes_are_rejected_without_a_spec(tmp_path):
    done = run("verify", CERTIFICATE, cwd=tmp_path, code=1)
    assert "REJECTED: its field 'couplings' does not follow" in done.stdout


@pytest.mark.parametrize(("known", "fault"), [((), "couplings"), (("couplings",), "statements")])
def test_none_of_it_holds_without_a_part(known, fault):
    """Without what axes do, the claim that it holds is another one."""
    document = copy.deepcopy(json.loads(CERTIFICATE.read_text()))
    for key in known:
        del document[key]
    found = prove(document | {"id": content_id(document)})
    assert found.certificate is None or found.fault
    assert fault in found.fault


def test_their_spec_is_refused(tmp_path):
    with pytest.raises(SpecError, match="unknown key `coupling`"):
        read_spec(SPEC)
    run("verify", CERTIFICATE, SPEC, cwd=tmp_path, code=2)


def test_the_short_checker_does_not_know_them(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["check_elsewhere.py", str(CERTIFICATE)])
    monkeypatch.setattr(sys, "tracebacklimit", 1000, raising=False)
    with pytest.raises(SystemExit) as done:
        runpy.run_path(str(ROOT / "docs/certificates/check_elsewhere.py"))
    assert done.value.code == 3
    assert "not checked here" in capsys.readouterr().out
