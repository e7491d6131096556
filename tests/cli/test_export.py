import json
import subprocess
from functools import partial
from pathlib import Path

import pytest

from nrs_design.certificates.certificate import content_id, dump
from nrs_design.certificates.verify import verify
from nrs_design.exporters.record import ExportRecord
from nrs_design.gating.lock import SCHEMA
from nrs_design.pipeline.runs import run_certification
from nrs_design.spec import read_spec
from tests.support import program_named, run, spec_in

SPECS = Path(__file__).parents[2] / "specs"
SPEC = SPECS / "neuroboscope/soft-tissue.nrs.yaml"


@pytest.fixture
def export(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    return partial(run, "export", cwd=tmp_path)


@pytest.fixture(scope="module")
def certificate():
    return dump(run_certification(read_spec(SPEC)).certificate)


def files():
    return sorted(str(path) for path in Path().rglob("*") if path.is_file())


def contents():
    return {name: Path(name).read_bytes() for name in files()}


def test_export_writes_the_record_and_its_certificate(export):
    document = json.loads(export(SPEC, "--out", "there", "--json", code=0).stdout)
    where, proof = "there/soft-tissue.export.json", "there/soft-tissue.cert.json"
    assert files() == sorted([where, proof])
    record = ExportRecord.model_validate_json(Path(where).read_text())
    checked = verify(Path(proof), read_spec(SPEC))
    assert checked.fault is None
    assert record.proof.certificate_id == checked.certificate.id
    assert record.spec.sha256 == read_spec(SPEC).sha256
    assert (document["schema"], document["verdict"]) == ("nrs-design/export/1", "proved")
    assert document["record"] == json.loads(Path(where).read_text())


def signed(text, edit):
    document = json.loads(text)
    edit(document)
    document["id"] = content_id(document)
    return json.dumps(document, indent=2)


@pytest.mark.parametrize(
    ("where", "locked", "out", "kept"),
    [
        pytest.param("reports/soft-tissue.cert.json", None, "reports", True, id="beside"),
        pytest.param("proofs/mine.cert.json", "itself", "there", True, id="locked"),
        pytest.param("reports/soft-tissue.cert.json", "another", "reports", False, id="not it"),
        pytest.param("reports/soft-tissue.cert.json", None, "there", False, id="not there"),
    ],
)
def test_what_is_recorded_and_holds_is_exported(export, certificate, where, locked, out, kept):
    """A search ends in other digits on another processor, and the lock would then be broken."""
    text = signed(certificate, lambda document: document["package"].update(version="0.1"))
    Path(where).parent.mkdir()
    Path(where).write_text(text)
    Path("a.nrs.yaml").write_text(SPEC.read_text())
    if locked is not None:
        found = json.loads(text)["id"] if locked == "itself" else "0" * 64
        entry = {"path": "a.nrs.yaml", "certificate": {"file": where, "id": found}, "rate": None}
        entry |= {"sha256": read_spec(SPEC).sha256, "version": "1", "verdict": "proved"}
        document = {"schema": SCHEMA, "specs": [entry | {"gains": {}, "goals": []}]}
        Path("nrs.lock").write_text(json.dumps(document))
    export("a.nrs.yaml", "--out", out, code=0)
    shipped = json.loads(Path(out, "soft-tissue.export.json").read_text())
    written = json.loads(Path(out, "soft-tissue.cert.json").read_text())
    assert shipped["proof"]["certificate_id"] == written["id"]
    assert (written["id"] == json.loads(text)["id"]) is kept


def other_gain(document):
    """The proof may well hold for a gain nearby, but it is not the one that was designed."""
    document["gains"]["insertion"]["Bt"] = "2.125"


def raised_rate(document):
    document["statements"][0]["rate"] = "99"


@pytest.mark.parametrize("edit", [other_gain, raised_rate])
def test_certificate_that_does_not_cover_the_design(export, certificate, edit):
    Path("mine.json").write_text(signed(certificate, edit))
    assert "not exported" in export(SPEC, "--certificate", "mine.json", code=1).stderr
    assert files() == ["mine.json"]


def sampled_text():
    head, _, _ = SPEC.read_text().partition("  withdrawal:")
    sampling = "switching: arbitrary\nsampling: {period: 2 ms, delay: 0}\n"
    return head.replace("name: soft-tissue", "name: every-2-ms") + sampling


def sampled_spec():
    Path("every-2-ms.nrs.yaml").write_text(sampled_text())
    return "every-2-ms.nrs.yaml"


@pytest.fixture(scope="module")
def sampled_certificate(tmp_path_factory):
    file = spec_in(tmp_path_factory.mktemp("sampled"), sampled_text(), "every-2-ms")
    return dump(run_certification(read_spec(file)).certificate)


@pytest.fixture
def sampled(export, sampled_certificate):
    Path("mine.json").write_text(sampled_certificate)
    return sampled_spec(), "mine.json"


@pytest.mark.parametrize("name", ["c", "json", "mat", "fmu"])
def test_the_export_of_another_spec_is_not_overwritten(export, sampled, name):
    spec, certificate = sampled
    options = ("--certificate", certificate, "--format", name, "--out", "out")
    export(spec, *options, code=0)
    for path in [*Path("out").iterdir()]:
        # An older text of the same spec is replaced, one of another spec stays.
        path.write_bytes(path.read_bytes().replace(b"every-2-ms", b"each-2-ms-"))
    before = contents()
    done = export(spec, *options, code=2)
    assert "was exported for the spec each-2-ms-" in done.stderr
    assert contents() == before


@pytest.mark.slow
def test_two_laws_make_one_program(export, sampled):
    """Tests of both are beside them, and neither brings a `main` that nobody asked for."""
    cc = program_named("cc")
    spec, certificate = sampled
    Path("other.nrs.yaml").write_text(Path(spec).read_text().replace("every-2-ms", "other"))
    for options in ((spec, "--certificate", certificate), ("other.nrs.yaml",)):
        export(*options, "--format", "c", "--out", "out", "-q", code=0)
    Path("main.c").write_text(
        """#include "other_test.h"
#include "every-2-ms_test.h"
int main(void) { return nrs_other_self_test() + nrs_every_2_ms_self_test() + 2; }
"""
    )
    sources = sorted(map(str, Path("out").glob("*.c")))
    flags = ("-std=c99", "-ffp-contract=off", "-Iout", "-o", "program")
    subprocess.run([cc, *flags, "main.c", *sources], check=True)
    subprocess.run(["./program"], check=True)
    subprocess.run([cc, *flags, "-DNRS_OTHER_TEST_PROGRAM", *sources], check=True)
    done = subprocess.run(["./program"], check=True, capture_output=True)
    assert done.stdout == b"other: all 1000 cases are the same\n"
