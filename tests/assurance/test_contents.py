"""What is in a folder, and that one thing is said alike in all of its files."""

import hashlib
import json

import pytest

from nrs_design.assurance.check import check_evidence
from tests.assurance.conftest import SAMPLED
from tests.support import ROOT, run

pytestmark = pytest.mark.slow
NAME = "soft-tissue-sampled"
PROOF = ("--certificate", ROOT / "reports" / f"{NAME}.cert.json")


def test_the_program_is_the_one_that_export_writes(sampled_folder, tmp_path):
    run("export", SAMPLED, *PROOF, "--format", "c", "--out", tmp_path, cwd=tmp_path, code=0)
    for ending in (".c", ".h"):
        exported = (tmp_path / f"{NAME}{ending}").read_bytes()
        assert (sampled_folder / "program" / f"{NAME}{ending}").read_bytes() == exported
        sha256 = hashlib.sha256(exported).hexdigest()
        for page in ("hazards.md", "SHA256SUMS"):
            assert sha256 in (sampled_folder / page).read_text()


def test_the_folder_of_a_sampled_design_holds(sampled_folder):
    found = check_evidence(sampled_folder, SAMPLED)
    assert (found.verdict, found.notes) == ("holds", ())


def test_pages_say_what_the_facts_say(sampled_folder):
    facts = json.loads((sampled_folder / "evidence.json").read_text())
    pages = {page.name: page.read_text() for page in sampled_folder.glob("*.md")}
    for row in facts["assumptions"]:
        assert (
            f"| `{row['id']}` | {row['covered_by']} | {row['state']} |" in pages["assumptions.md"]
        )
        assert all(statement in pages["assumptions.md"] for statement in row["statements"])
    for id in facts["open"]:
        assert f"  {id}: {{" in (sampled_folder / "results-to-do.yaml").read_text()
    for row in facts["hazards"]:
        assert f"## `{row['id']}`" in pages["hazards.md"]
    for controller, gains in facts["gains"].items():
        for gain, value in gains.items():
            assert f"| {controller} | {gain} | {value} |" in pages["README.md"]
    assert facts["claim"] in pages["README.md"]
    assert {"program.vectors", "program.binary"} <= set(facts["open"])
    assert "program/" in pages["standards.md"]


def test_no_file_names_this_machine(sampled_folder):
    here = str(ROOT).encode()
    assert [p.name for p in sampled_folder.rglob("*.*") if here in p.read_bytes()] == []


@pytest.fixture(scope="module")
def built_folder(sampled_folder, tmp_path_factory):
    """With the record of a build of its program."""
    folder = tmp_path_factory.mktemp("built")
    facts = json.loads((sampled_folder / "evidence.json").read_text())
    sources = (f"{NAME}.c", f"{NAME}.h")
    record = {
        "schema": "nrs-design/binary/1",
        "spec": {"name": NAME, "sha256": facts["spec"]["sha256"]},
        "certificate": facts["certificate"]["id"],
        "compiler": {"version": "gcc 13.2", "target": "arm-none-eabi"},
        "compile": ["arm-none-eabi-gcc"],
        "run": ["qemu-system-arm"],
        "result": "passed",
        "compared": {
            name: hashlib.sha256((sampled_folder / "program" / name).read_bytes()).hexdigest()
            for name in sources
        },
        "compiled": {f"{NAME}.o": "3" * 64},
        "not_compared": ["silicon: an emulator ran it"],
    }
    (folder / "build").write_text(json.dumps(record))
    given = (*PROOF, "--build", "build", "--out", "a")
    run("evidence", SAMPLED, *given, cwd=folder, code=0)
    return folder / "a"


def test_a_build_leads_from_the_source_to_the_object(built_folder):
    assert "Sn4.1 (solution): build.json: passed" in (built_folder / "argument.txt").read_text()
    page = (built_folder / "hazards.md").read_text()
    assert f"| `{NAME}.o`, as build.json says | {'3' * 64} |" in page
    assert "Not looked at: silicon: an emulator ran it." in page


def test_a_folder_with_a_build_holds(built_folder):
    assert check_evidence(built_folder).verdict == "holds"
