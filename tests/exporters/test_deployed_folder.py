"""A folder of deployed files: every single change is found, and what was not compared is said."""

import re
import shutil

import pytest

from nrs_design.exporters import format_of, rendered
from nrs_design.exporters.deployed import compare_deployed, find_differences
from tests.exporters.programs import write_formats

FORMATS = ("c", "vectors", "monitor", "cmake")
OWN, UP = "nrs_soft_tissue", "NRS_SOFT_TISSUE"


@pytest.fixture(scope="module")
def exported(sampled_export, tmp_path_factory):
    """The folder as it was exported."""
    return write_formats(tmp_path_factory.mktemp("exported"), sampled_export, FORMATS)


@pytest.fixture
def folder(exported, tmp_path):
    return shutil.copytree(exported, tmp_path / "firmware")


@pytest.fixture(scope="module")
def texts(sampled_export):
    """What is exported: the same for all changes, so it is made once."""
    return {name: rendered(name, sampled_export) for name in FORMATS}


@pytest.fixture(autouse=True)
def _made_once(texts, monkeypatch):
    def made(name, export):
        return texts[name] if name in texts else rendered(name, export)

    monkeypatch.setattr("nrs_design.exporters.deployed.rendered", made)


@pytest.fixture
def compared(folder, sampled, sampled_export):
    return lambda: compare_deployed(folder, sampled.spec, sampled_export.certificate)


def test_a_folder_as_exported(folder, compared, sampled_export):
    (folder / "soft-tissue.cert.json").write_text("{}")
    (folder / "main.c").write_text("int main(void) { return 0; }")
    found = compared()
    assert found.differences == ()
    assert {file.name for file in found.compared} == {
        f"soft-tissue{ending}" for name in FORMATS for ending in format_of(name).files
    }
    assert found.left_out == ("comments, how it is compiled, the release that wrote it, main.c")
    for name in ("json", "fmu"):
        write_formats(folder, sampled_export, (name,))
    assert compared().differences == ()


# What is changed, in which file, from what to what: numbers, types, fields, operations, order.
CHANGES = [
    ("a number by its last bit", ".h", r"0x1\.f6eep\+19F", "0x1.f6ee02p+19F"),
    ("a limit", ".h", rf"({UP}_MAX_TORQUE) \S+", r"\1 0x1.0p+30F"),
    ("the number of a mode", ".h", rf"({UP}_MODE_INSERTION) 0U", r"\1 1U"),
    ("the type of a field", ".h", "float torque;", "double torque;"),
    ("the type of the mode", ".h", "uint32_t mode;", "uint8_t mode;"),
    ("the type of a flag", ".h", "bool valid;", "int valid;"),
    ("the order of inputs", ".h", r"(float angle;.*\n)(.*float torque;.*\n)", r"\2\1"),
    ("the order of states", ".h", r"(float reference;.*\n)(.*float error_before;.*\n)", r"\2\1"),
    ("a field more", ".h", "float torque;", "float torque; float other;"),
    ("a field less", ".h", r".*float torque;.*\n", ""),
    ("the order of arguments", ".h", r"(    \w+_state_t \*state,\n)(.*\*out)", r"\2, \1"),
    ("how fields are laid out", ".h", r"(#include <stdint.h>)", r"\1\n#pragma pack(1)"),
    ("the names for C++", ".h", 'extern "C" ', ""),
    ("a sign", ".c", "proportional \\+ derivative", "proportional - derivative"),
    ("an operand", ".c", "state->reference - in->angle", "state->velocity - in->angle"),
    ("the order of operations", ".c", r"(.*float kept.*\n)(.*float pushed.*\n)", r"\2\1"),
    ("a guard", ".c", r" &&\n\s+is_within\(in->torque, \w+\)", ""),
    ("a comparison", ".c", "value <= limit", "value < limit"),
    ("a saturation", ".c", r"saturated\((in->velocity_command), \w+\)", r"\1"),
    ("what a state becomes", ".c", "state->velocity = next_velocity", "state->velocity = kept"),
    ("what is commanded", ".c", r"out->command = 0\.0F", "out->command = 1.0F"),
    ("how it starts", ".c", "state->reference = angle", "state->reference = 0.0F"),
    ("a coefficient", ".c", rf"{UP}_A\b", f"{UP}_B"),
    ("contraction of products", ".c", "#pragma GCC optimize.*\n", ""),
    ("fast arithmetic", ".c", r"defined\(__FAST_MATH__\) \|\| ", ""),
    ("a case", "_test.c", r"\{0x0U, 0x\w", "{0x0U, 0x7"),
    ("a column that is not tested", "_test.c", r" &&\n\s+\(to_bits\(out\.command\) == \S+\)", ""),
    ("a test that always passes", "_test.c", "first >= 0", "first >= 1000"),
    ("how many cases", "_test.h", "_TEST_CASES 1000", "_TEST_CASES 10"),
    ("a bit of the vectors", ".vectors.json", r'(\n    \[0, "\w{7})\w', r"\1x"),
    ("the order of columns", ".vectors.csv", "angle,torque", "torque,angle"),
    ("a tolerance in Python", "_test.py", "packed.hex\\(\\) == bits", "True"),
    ("a limit of the monitor", "_monitor.h", r"(MONITOR_TORQUE) \S+", r"\1 0x1.0p+9F"),
    ("a check of the monitor", "_monitor.c", "m->left == ", "m->left != "),
    ("a flag", ".cmake", "-ffp-contract=off", "-ffast-math"),
]


@pytest.mark.parametrize(("ending", "old", "new"), [change[1:] for change in CHANGES])
def test_each_single_change_is_found(sampled, sampled_export, texts, tmp_path, ending, old, new):
    exported = next(files[ending] for files in texts.values() if ending in files).decode()
    text, count = re.subn(old, new, exported, count=1)
    assert count == 1
    assert text != exported
    file = tmp_path / f"soft-tissue{ending}"
    file.write_text(text)
    assert len(find_differences(file, sampled.spec, sampled_export.certificate)) == 1


def test_changes_are_told_by_file(folder, compared):
    for ending, old, new in (("_monitor.h", "float torque", "double torque"), (".c", " * ", " + ")):
        file = folder / f"soft-tissue{ending}"
        file.write_text(file.read_text().replace(old, new))
    first, second = compared().differences
    assert first.startswith("soft-tissue.c: line ")
    assert second.startswith("soft-tissue_monitor.h: line ")


def test_there_are_thirty_changes_of_each_kind():
    assert len({what for what, *_ in CHANGES}) == len(CHANGES) >= 30
    assert {ending for _, ending, *_ in CHANGES} >= {".h", ".c", "_test.c", "_monitor.c", ".cmake"}


@pytest.mark.parametrize("missing", [".h", ".c", "_test.h", "_monitor.c"])
def test_a_file_that_is_missing(folder, compared, missing):
    (folder / f"soft-tissue{missing}").unlink()
    assert compared().differences == (f"soft-tissue{missing}: it is missing",)


def test_a_folder_without_the_law(tmp_path, sampled, sampled_export):
    """What has its ending for its whole name is no file of the spec."""
    (tmp_path / ".h").write_text("")
    found = compare_deployed(tmp_path, sampled.spec, sampled_export.certificate)
    assert found.differences == ("soft-tissue.c: it is missing", "soft-tissue.h: it is missing")


@pytest.mark.parametrize("text", ["", "{", "[]", "[" * 10_000, '{"cases": 1, "cases": []}'])
def test_vectors_that_are_something_else(folder, compared, text):
    (folder / "soft-tissue.vectors.json").write_text(text)
    assert compared().differences


def test_who_wrote_the_vectors_does_not_count(folder, compared, texts):
    text = texts["vectors"][".vectors.json"].decode()
    other = re.sub(r"nrs-design [\d.]+, ", "nrs-design 9.9, ", text)
    assert other != text
    (folder / "soft-tissue.vectors.json").write_text(other)
    assert compared().differences == ()
