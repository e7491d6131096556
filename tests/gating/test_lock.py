import json

import pytest

from nrs_design.errors import CertificateError, OutputError
from nrs_design.gating.find_specs import find_specs
from nrs_design.gating.lock import Lock, dump_lock, make_lock, read_lock, write_lock
from nrs_design.gating.run import Files, run_gate

from .conftest import BROKEN


def test_lock_names_specs_and_certificates_relative_to_itself(project):
    lock = read_lock(project / "nrs.lock")
    assert [spec.path for spec in lock.specs] == [
        "specs/soft-tissue.nrs.yaml",
        "specs/stable.nrs.yaml",
    ]
    for spec in lock.specs:
        certificate = json.loads((project / spec.certificate.file).read_text())
        assert certificate["id"] == spec.certificate.id
        assert certificate["spec"]["sha256"] == spec.sha256


def test_lock_is_the_same_on_repeat(project):
    before = (project / "nrs.lock").read_bytes()
    outcome = run_gate(find_specs([project / "specs"]), Files(project / "reports", html=False))
    write_lock(outcome, project / "nrs.lock")
    assert (project / "nrs.lock").read_bytes() == before


def test_lock_elsewhere_names_the_same_files(project):
    outcome = run_gate(find_specs([project / "specs"]), Files(project / "reports", html=False))
    lock = make_lock(outcome.specs, project / "ci/nrs.lock")
    assert lock.specs[0].path == "../specs/soft-tissue.nrs.yaml"


def test_lock_reads_back(project):
    lock = read_lock(project / "nrs.lock")
    assert Lock.model_validate(json.loads(dump_lock(lock))) == lock


def test_lock_is_left_alone_where_a_spec_has_no_verdict(project):
    before = (project / "nrs.lock").read_bytes()
    (project / "specs/stable.nrs.yaml").write_text(BROKEN)
    outcome = run_gate(find_specs([project / "specs"]), Files(project / "reports", html=False))
    noted = write_lock(outcome, project / "nrs.lock")
    assert "not written" in noted.notes[0]
    assert (project / "nrs.lock").read_bytes() == before


def test_unwritable_lock(project):
    outcome = run_gate([project / "specs/stable.nrs.yaml"], Files(project, html=False))
    with pytest.raises(OutputError):
        write_lock(outcome, project / "specs/stable.nrs.yaml/nrs.lock")


ENTRY = {
    "path": "a.nrs.yaml",
    "sha256": "0" * 64,
    "verdict": "proved",
    "rate": "1",
    "certificate": {"file": "a.cert.json", "id": "1" * 64},
}


def document(*entries, **changes):
    package = {"name": "nrs-design", "version": "0"}
    base = {"schema": "nrs-design/lock/1", "package": package, "specs": list(entries)}
    return json.dumps({**base, **changes})


def test_the_sample_itself_is_a_lock(tmp_path):
    (tmp_path / "nrs.lock").write_text(document(ENTRY))
    assert read_lock(tmp_path / "nrs.lock").specs[0].path == "a.nrs.yaml"


@pytest.mark.parametrize("certificate", [None, ENTRY["certificate"]])
def test_an_inconclusive_spec_may_have_the_certificate_of_a_remark(tmp_path, certificate):
    entry = {**ENTRY, "verdict": "inconclusive", "rate": None, "certificate": certificate}
    (tmp_path / "nrs.lock").write_text(document(entry))
    assert read_lock(tmp_path / "nrs.lock").specs[0].verdict == "inconclusive"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{",
        "[" * 100_000,
        "\x00",
        document(schema="nrs-design/lock/2"),
        document(extra=1),
        document(specs=None),
        document(ENTRY, ENTRY),
        document({**ENTRY, "verdict": "fine"}),
        document({**ENTRY, "sha256": "0" * 63}),
        document({**ENTRY, "certificate": None}),
        document({**ENTRY, "verdict": "inconclusive"}),
        document({**ENTRY, "path": 1}),
        document({**ENTRY, "unknown": 1}),
        document(ENTRY).replace('"rate"', '"path"'),
    ],
)
def test_what_is_not_a_lock_is_refused(tmp_path, text):
    (tmp_path / "nrs.lock").write_text(text)
    with pytest.raises(CertificateError, match="not a lock file") as caught:
        read_lock(tmp_path / "nrs.lock")
    assert caught.value.path == tmp_path / "nrs.lock"
    assert "\n" not in caught.value.message


def test_bytes_that_are_no_text_are_refused(tmp_path):
    (tmp_path / "nrs.lock").write_bytes(b"\xff\xfe")
    with pytest.raises(CertificateError, match="not a lock file"):
        read_lock(tmp_path / "nrs.lock")


@pytest.mark.parametrize("name", ["missing", "."])
def test_a_lock_that_cannot_be_read(tmp_path, name):
    with pytest.raises(CertificateError):
        read_lock(tmp_path / name)
