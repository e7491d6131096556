import json
import shutil

import pytest

from nrs_design.certificates.certificate import content_id
from tests.support import COMMUTING, PRINT_ERROR, SOFT_TISSUE, document_of, run, started


@pytest.fixture(scope="module")
def certified(tmp_path_factory):
    folder = tmp_path_factory.mktemp("certified")
    for spec in (SOFT_TISSUE, PRINT_ERROR, COMMUTING):
        name = spec.name.removesuffix(".nrs.yaml")
        run("certify-switching", spec, "--out", f"{name}.json", cwd=folder)
    return folder


def test_without_a_spec_what_is_altered_is_rejected(certified, tmp_path):
    document = json.loads((certified / "commuting.json").read_text())
    document["modes"][0]["numerators"][0][0] *= -1
    (tmp_path / "c.json").write_text(json.dumps(document))
    found = document_of("verify", "c.json", COMMUTING, cwd=tmp_path, code=1)
    assert (found["verdict"], "altered" in found["fault"]) == ("rejected", True)
    assert found["claims"] is found["gains"] is found["certificate_id"] is None
    assert "REJECTED: its content" in run("verify", "c.json", cwd=tmp_path).stdout
    document["id"] = content_id(document)
    (tmp_path / "c.json").write_text(json.dumps(document))
    assert "REJECTED: V does not decrease" in run("verify", "c.json", cwd=tmp_path, code=1).stdout


def test_disagreement_is_an_internal_error(certified):
    """Flint says no where the integer check says yes: exit code 4 and no verdict."""
    program = (
        "import sys; from nrs_design.certificates import second_opinion as s; "
        "s.has_positive_spectrum = lambda M: False; "
        "sys.argv = ['nrs-design', *sys.argv[1:]]; from nrs_design.cli import main; main()"
    )
    for arguments in (["verify", "commuting.json", COMMUTING], ["certify-switching", COMMUTING]):
        result = started("-c", program, *arguments, cwd=certified)
        assert result.returncode == 4
        assert "InternalError" in result.stderr
        assert "PROVED" not in result.stdout
    assert not (certified / "reports").exists()


@pytest.fixture(scope="module")
def firmware(tmp_path_factory):
    """Insertion every 2 ms, exported in every format that is compared and as a record, into x."""
    folder = tmp_path_factory.mktemp("deployed")
    head, _, _ = SOFT_TISSUE.read_text().partition("  withdrawal:")
    sampling = "switching: arbitrary\nsampling: {period: 2 ms, delay: 0}\n"
    (folder / "x.nrs.yaml").write_text(head.replace("name: soft-tissue", "name: x") + sampling)
    run("export", "x.nrs.yaml", "--out", "x", "-q", "--format", "c", cwd=folder, code=0)
    again = ("export", "x.nrs.yaml", "--out", "x", "-q", "--certificate", "x/x.cert.json")
    for name in ("json", "monitor", "cmake", "fmu"):
        run(*again, "--format", name, cwd=folder, code=0)
    return folder


@pytest.fixture
def deployed(firmware, tmp_path):
    return shutil.copytree(firmware, tmp_path / "deployed")


CHECK = ("verify", "x/x.cert.json", "x.nrs.yaml", "--deployed")


def test_deployed_files_are_those_of_the_certificate(deployed):
    for name in ("x.h", "x_test.c", "x.fmu"):
        first = run(*CHECK, f"x/{name}", cwd=deployed, code=0).stdout.splitlines()[0]
        assert first.startswith(f"deployed: x/{name}: as exported with the certificate, byte for")
        assert first.endswith("; not compared: how it is compiled")
    first = run(*CHECK, "x", cwd=deployed, code=0).stdout.splitlines()[0]
    assert first.startswith("deployed: 8 files of x: as exported")
    assert first.endswith("; not compared: how it is compiled, x.export.json")
    text = (deployed / "x/x.h").read_text()
    assert text.count("0x1.f6eep+19F") == 1
    (deployed / "x/x.h").write_text(text.replace("0x1.f6eep+19F", "0x1.f6ee02p+19F"))
    for place in ("x", "x/x.h"):
        shown = run(*CHECK, place, cwd=deployed, code=1).stdout
        assert shown.startswith(f"REJECTED: {place} is not what the certificate is about\n  x.h: ")
        assert "it has '#define NRS_X_KD_OVER_T 0x1.f6ee02p+19F" in shown
        document = document_of(*CHECK, place, cwd=deployed)
        assert (document["verdict"], document["deployed"]) == ("rejected", place)
        assert len(document["differences"]) == 1
