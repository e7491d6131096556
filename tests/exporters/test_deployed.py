"""Deployed files against a certificate: every byte counts, and what was not compared is said."""

import re
import shutil

import pytest

from nrs_design.errors import NrsDesignError
from nrs_design.exporters import format_names, format_of, rendered
from nrs_design.exporters.deployed import LARGEST_BYTES, compare_deployed
from nrs_design.exporters.export import Execution, export_design
from nrs_design.pipeline.runs import run_certification
from nrs_design.spec import read_spec
from tests.exporters.programs import write_formats
from tests.support import ROBOT, ROOT
from tests.tables import rows

EXECUTABLE = [name for name in format_names() if format_of(name).executable]
UP = "NRS_SOFT_TISSUE"


@pytest.fixture(scope="module")
def exported(sampled_export, tmp_path_factory):
    return write_formats(tmp_path_factory.mktemp("exported"), sampled_export, EXECUTABLE)


@pytest.fixture(scope="module")
def texts():
    return {}


@pytest.fixture(autouse=True)
def _made_once(texts, monkeypatch):
    def made(name, export):
        key = name, export.certificate.id
        if key not in texts:
            texts[key] = rendered(name, export)
        return texts[key]

    monkeypatch.setattr("nrs_design.exporters.deployed.rendered", made)


@pytest.fixture
def folder(exported, tmp_path):
    return shutil.copytree(exported, tmp_path / "firmware")


@pytest.fixture
def compared(folder, sampled, sampled_export):
    def compare(name="."):
        return compare_deployed(folder / name, sampled.spec, sampled_export.certificate)

    return compare


def test_a_folder_as_exported(folder, compared):
    (folder / "soft-tissue.cert.json").write_text("{}")
    (folder / "main.c").write_text("int main(void) { return 0; }")
    # A compiler takes this one, too, where its folder is named first.
    for name in ("old/soft-tissue.h", ".git/objects/a", ".git/objects/b"):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()
    found = compared()
    assert found.differences == ()
    assert {file.name for file in found.compared} == {
        f"soft-tissue{ending}" for name in EXECUTABLE for ending in format_of(name).files
    }
    assert found.left_out == "how it is compiled, .git, main.c, old/soft-tissue.h"


@pytest.mark.parametrize("ending", [".h", "_test.c", ".fmu"])
def test_a_file_as_exported(compared, folder, ending):
    found = compared(f"soft-tissue{ending}")
    assert (found.compared, found.differences) == ((folder / f"soft-tissue{ending}",), ())
    assert found.left_out == "how it is compiled"


@pytest.mark.parametrize(
    ("ending", "old", "new"), rows(__file__, "test_each_single_change_is_found")
)
def test_each_single_change_is_found(folder, compared, ending, old, new):
    file = folder / f"soft-tissue{ending}"
    text = file.read_text()
    changed, count = re.subn(old, new, text, count=1)
    assert count == 1
    assert changed != text
    file.write_bytes(changed.encode())
    (found,) = compared(file.name).differences
    assert found.startswith(f"{file.name}: line ")


def test_the_first_place_is_shown_with_what_belongs_there(folder, compared):
    """Quoted: an escape of a terminal, or the end of a line, is seen and does nothing."""
    header, source = folder / "soft-tissue.h", folder / "soft-tissue.c"
    header.write_text(header.read_text().replace(f"{UP}_KP 0x1.", f"{UP}_KP \x1b[2J0x1."))
    source.write_bytes(source.read_bytes().replace(b"\n", b"\r\n"))
    first, second = compared().differences
    assert first == (
        "soft-tissue.c: line 1: it has '/* nrs-design C source\\r', and the export has "
        "'/* nrs-design C source'"
    )
    number, line = next(
        (k, line) for k, line in enumerate(header.read_text().split("\n"), 1) if "\x1b" in line
    )
    assert f"{UP}_KP" in line
    assert second.startswith(f"soft-tissue.h: line {number}: it has '#define {UP}_KP \\x1b[2J0x1.")
    assert f"and the export has '#define {UP}_KP 0x1." in second


def test_a_model_counts_to_the_last_byte(folder, compared):
    file = folder / "soft-tissue.fmu"
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)
    (found,) = compared().differences
    assert found.startswith("soft-tissue.fmu: it differs (a library in it must")


@pytest.mark.parametrize("ending", [".h", ".cmake", "_test.c", ".fmu"])
def test_a_file_of_another_release_is_named_as_such(folder, compared, ending):
    """Every byte may differ then, so no single one is told; nor is it accepted."""
    file = folder / f"soft-tissue{ending}"
    text, count = re.subn(
        rb"nrs-design [\d.]+(?=, nrs-design/export)", b"nrs-design 0.9.1", file.read_bytes()
    )
    assert count
    file.write_bytes(text.replace(b"0x1.f6eep+19F", b"0x1.f6ee02p+19F"))
    (found,) = compared().differences
    assert found.startswith(f"{file.name}: nrs-design 0.9.1 wrote it, and what ")


@pytest.mark.parametrize("missing", [".h", ".c", "_monitor.c"])
def test_code_that_is_missing(folder, compared, missing):
    (folder / f"soft-tissue{missing}").unlink()
    assert compared().differences == (f"soft-tissue{missing}: it is missing",)


def test_a_self_test_and_formats_that_were_not_deployed_are_not_missed(folder, compared):
    for file in [*folder.iterdir()]:
        if file.name not in ("soft-tissue.h", "soft-tissue.c"):
            file.unlink()
    assert compared().differences == ()


def test_a_folder_without_the_law(tmp_path, sampled, sampled_export):
    """What has its ending for its whole name is no file of the spec."""
    (tmp_path / ".h").write_text("")
    found = compare_deployed(tmp_path, sampled.spec, sampled_export.certificate)
    assert found.differences == ("soft-tissue.c: it is missing", "soft-tissue.h: it is missing")


@pytest.mark.parametrize("name", ["law.hpp", "other.h", "soft-tissue.export.json"])
def test_files_that_are_something_else(folder, compared, name):
    (folder / name).touch()
    with pytest.raises(NrsDesignError, match="none of the files that are compared") as caught:
        compared(name)
    assert "c, cmake, fmu, monitor" in caught.value.remedy
    assert caught.value.path == folder / name


def test_files_that_cannot_be_read(folder, compared):
    file = folder / "soft-tissue.h"
    file.write_bytes(b" " * (LARGEST_BYTES + 1))
    with pytest.raises(NrsDesignError, match="larger than any export"):
        compared()
    file.unlink()
    with pytest.raises(NrsDesignError, match="cannot be read"):
        compared(file.name)


def test_a_certificate_in_continuous_time_says_nothing_of_a_program(
    folder, continuous, continuous_export
):
    with pytest.raises(NrsDesignError, match="continuous time"):
        compare_deployed(folder, continuous.spec, continuous_export.certificate)


def test_a_certificate_of_two_periods_says_nothing_of_a_program_of_one(folder, sampled):
    file = folder / "two.nrs.yaml"
    file.write_text(sampled.text.replace("delay: [0, 1]", "outer_period: 4 ms, delay: 0"))
    result = run_certification(read_spec(file))
    with pytest.raises(NrsDesignError, match="the certificate is about two periods"):
        compare_deployed(folder, result.designed.spec, result.certificate)


@pytest.mark.parametrize("name", ["force-limit-sampled", "force-limit-pi-sampled"])
def test_laws_of_other_kinds_are_those_of_their_certificates(tmp_path, name):
    """Every line of a file follows from spec and certificate; nothing else is in it."""
    certificate = ROOT / f"reports/{name}.cert.json"
    loaded = read_spec(ROBOT / f"{name}.nrs.yaml")
    export = export_design(loaded, certificate, execution=Execution())
    write_formats(tmp_path, export, ("c", "monitor"))
    found = compare_deployed(tmp_path, loaded.spec, export.certificate)
    assert (len(found.compared), found.differences) == (6, ())
