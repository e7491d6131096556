"""A folder is checked as by somebody who suspects its author: hashes can be made to fit."""

import hashlib
import json
import shutil

import pytest

from nrs_design.assurance.case import UserFile
from nrs_design.assurance.check import check_evidence
from nrs_design.assurance.contents import sums_of
from nrs_design.assurance.folder import read_folder
from nrs_design.certificates.certificate import content_id
from nrs_design.errors import CertificateError
from tests.support import COMMUTING, SOFT_TISSUE


def sign(folder):
    """Make the hashes fit what is there now."""
    files = read_folder(folder)
    files.pop("SHA256SUMS")
    (folder / "SHA256SUMS").write_bytes(sums_of(files))


def edit(folder, name, old, new):
    path = folder / name
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    sign(folder)


def edit_facts(folder, **changes):
    path = folder / "evidence.json"
    facts = json.loads(path.read_text()) | changes
    path.write_text(json.dumps(facts, indent=2) + "\n")
    sign(folder)


def faults(folder, *arguments):
    return check_evidence(folder, *arguments).faults


def test_a_folder_as_it_was_written_holds(folder):
    found = check_evidence(folder)
    assert (found.verdict, found.faults, found.notes) == ("holds", (), ())
    assert found.case is not None
    assert found.files == len(read_folder(folder))


def test_a_folder_holds_wherever_it_is(folder, tmp_path):
    moved = tmp_path / "a" / "b"
    shutil.copytree(folder, moved)
    shutil.rmtree(folder)
    assert check_evidence(moved).verdict == "holds"


def test_a_changed_file_is_found(folder):
    (folder / "tool.md").write_text("x")
    assert faults(folder) == ("'tool.md' was changed",)


PAGES = ["README.md", "assumptions.md", "hazards.md", "argument.svg", "argument.txt"]
PAGES += ["standards.md", "tool.md", "results-to-do.yaml", ".gitattributes"]


@pytest.mark.parametrize("page", PAGES)
def test_a_changed_page_is_found_although_its_hash_fits(folder, page):
    (folder / page).write_text((folder / page).read_text() + " ")
    sign(folder)
    assert faults(folder) == (f"{page} is not what spec, certificate and results give",)


def test_a_better_claim_is_found_although_its_hash_fits(folder):
    facts = json.loads((folder / "evidence.json").read_text())
    edit_facts(folder, claim=facts["claim"] + " At any speed.")
    assert "evidence.json is not what spec, certificate and results give" in faults(folder)


def test_a_file_more_is_found_although_its_hash_fits(folder):
    (folder / "program").mkdir()
    (folder / "program/law.c").write_text("")
    sign(folder)
    assert faults(folder) == ("'program/law.c' is there, and spec and certificate give none",)


def test_a_page_less_is_found_although_the_hashes_fit(folder):
    (folder / "hazards.md").unlink()
    sign(folder)
    assert "hazards.md is missing: spec and certificate give one" in faults(folder)


def test_a_better_rate_is_found_although_id_and_hash_fit(folder):
    path = folder / "commuting.cert.json"
    document = json.loads(path.read_text())
    statement = next(s for s in document["statements"] if "rate" in s)
    statement["rate"] = "1/2"
    document["id"] = content_id(document)
    path.write_text(json.dumps(document, indent=2) + "\n")
    sign(folder)
    (fault,) = faults(folder)
    assert "commuting.cert.json" in fault


def test_the_certificate_of_another_spec_is_found(folder):
    edit(folder, "spec/commuting.nrs.yaml", "name: commuting", "name: commuting2")
    (fault,) = faults(folder)
    assert "it belongs to another spec" in fault


def test_the_spec_of_now_must_say_the_same(folder, tmp_path):
    assert faults(folder, COMMUTING) == ()
    assert "says something else than the spec in the folder" in faults(folder, SOFT_TISSUE)[0]


def test_a_binary_must_be_one_that_is_named(folder):
    other = UserFile("firmware.bin", 1, hashlib.sha256(b"x").hexdigest())
    assert faults(folder, None, (other,)) == (
        "firmware.bin is none of the binaries that the folder names",
    )


def test_a_folder_of_another_release_is_not_decided(folder):
    edit_facts(folder, package={"name": "nrs-design", "version": "0.0.9"})
    found = check_evidence(folder)
    assert (found.verdict, found.faults) == ("inconclusive", ())
    assert "written by release 0.0.9" in found.undecided


def test_a_folder_of_another_checker_is_not_decided(folder):
    facts = json.loads((folder / "evidence.json").read_text())
    edit_facts(folder, decides={**facts["decides"], "sha256": "0" * 64})
    assert check_evidence(folder).verdict == "inconclusive"


def test_other_installed_parts_are_told(folder):
    edit(folder, "sbom.cdx.json", '"version": "', '"version": "0.')
    found = check_evidence(folder)
    assert found.verdict == "holds"
    assert found.notes == ("sbom.cdx.json lists other parts than are here",)


@pytest.mark.parametrize(
    "changes",
    [
        {"spec": {"name": "commuting", "file": "../commuting.nrs.yaml"}},
        {"spec": {"name": "commuting", "file": "/etc/hostname"}},
        {"spec": 1},
        {"certificate": {"file": ["x"]}},
        {"binaries": [{}]},
        {"binaries": 3},
        {"package": None},
    ],
)
def test_hostile_facts_are_rejected(folder, changes):
    edit_facts(folder, **changes)
    assert len(faults(folder)) == 1


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"schema": "other"}', '{"a": 1, "a": 2}'])
def test_what_is_no_evidence_is_refused(folder, text):
    (folder / "evidence.json").write_text(text)
    with pytest.raises(CertificateError, match="not of the format"):
        check_evidence(folder)


def test_a_folder_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(CertificateError, match="there is no such folder"):
        check_evidence(tmp_path / "none")
