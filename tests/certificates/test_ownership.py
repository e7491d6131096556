import json

import pytest

from nrs_design.certificates.certificate import dump
from nrs_design.certificates.ownership import check_certificate, check_name, check_owner, origin_of
from nrs_design.errors import OutputError
from nrs_design.output import PAGE
from nrs_design.pipeline.runs import run_certification
from nrs_design.spec import read_spec
from tests.support import COMMUTING


@pytest.fixture
def folder(tmp_path):
    """Two copies of a spec, and the files that the first of them owns."""
    for name in ("specs", "reports"):
        (tmp_path / name).mkdir()
    for name in ("specs/first.nrs.yaml", "second.nrs.yaml"):
        (tmp_path / name).write_bytes(COMMUTING.read_bytes())
    first = tmp_path / "specs/first.nrs.yaml"
    certificate = run_certification(read_spec(first)).certificate
    file = tmp_path / "reports/commuting.cert.json"
    file.write_text(dump(certificate, origin_of(first, file)))
    page = f'{PAGE.decode()}<meta name="spec" content="{origin_of(first, file)}">\n'
    (tmp_path / "reports/commuting.html").write_text(page)
    return tmp_path


def test_origin_is_relative_with_forward_slashes(folder):
    file = folder / "reports/commuting.cert.json"
    assert json.loads(file.read_text())["origin"] == "../specs/first.nrs.yaml"
    assert origin_of(folder / "\udcff.nrs.yaml", folder / "x") == "\\xff.nrs.yaml"


def test_the_owner_may_overwrite_by_whatever_name(folder, monkeypatch):
    reports = folder / "reports"
    first = folder / "specs/first.nrs.yaml"
    first.write_text(first.read_text() + "# edited\n")
    (folder / "link.nrs.yaml").symlink_to(first)
    for spec in (first, folder / "specs/../specs/first.nrs.yaml", folder / "link.nrs.yaml"):
        check_owner(spec, "commuting", reports)
    monkeypatch.chdir(folder / "specs")
    check_owner(first.relative_to(folder / "specs"), "commuting", reports)


def test_a_project_that_moved_is_its_own_owner(folder, tmp_path_factory):
    moved = tmp_path_factory.mktemp("moved") / "project"
    folder.rename(moved)
    check_owner(moved / "specs/first.nrs.yaml", "commuting", moved / "reports")
    with pytest.raises(OutputError):
        check_owner(moved / "second.nrs.yaml", "commuting", moved / "reports")


@pytest.mark.parametrize("missing", ["none", "cert.json", "html"])
def test_another_spec_may_not(folder, missing):
    (folder / f"reports/commuting.{missing}").unlink(missing_ok=True)
    with pytest.raises(OutputError, match=r"belongs to .*specs/first\.nrs\.yaml") as caught:
        check_owner(folder / "second.nrs.yaml", "commuting", folder / "reports")
    assert "`name` of its own" in caught.value.remedy


def test_other_names_and_places_are_free_and_a_spec_that_is_gone_owns_nothing(folder):
    check_owner(folder / "second.nrs.yaml", "other", folder / "reports")
    check_owner(folder / "second.nrs.yaml", "commuting", folder)
    (folder / "specs/first.nrs.yaml").unlink()
    check_owner(folder / "second.nrs.yaml", "commuting", folder / "reports")


@pytest.mark.parametrize("text", ["", "precious", "[]", "{}", '{"schema": "nrs-design/lock/2"}'])
def test_what_is_no_certificate_is_nobodys_to_overwrite(folder, text):
    file = folder / "reports/commuting.cert.json"
    file.write_text(text)
    with pytest.raises(OutputError, match="exists already"):
        check_certificate(folder / "specs/first.nrs.yaml", file)


@pytest.mark.parametrize("origin", [None, 7, ["x"], "a\0b", "x" * 5000, "/dev/null"])
def test_a_certificate_with_a_strange_origin_has_no_owner(folder, origin):
    file = folder / "reports/commuting.cert.json"
    file.write_text(json.dumps({**json.loads(file.read_text()), "origin": origin}))
    check_certificate(folder / "second.nrs.yaml", file)


SHA = 64 * "a"


@pytest.mark.parametrize(
    "text",
    [
        f"/* nrs-design C header\n * spec: mine, sha256 {SHA}\n",
        f"/* nrs-design C header\n * spec: mine, sha256\n *   {SHA}\n",
        f"# nrs-design CMake file\n# spec: mine, sha256 {SHA}\n",
        '{\n  "schema": "nrs-design/export/1",\n  "spec": {\n    "name": "mine",\n',
        "MATLAB 5.0 MAT-file, nrs-design export of mine      ",
    ],
)
def test_the_export_of_a_spec_of_another_name_stays(tmp_path, text):
    file = tmp_path / "x"
    check_name("mine", file)
    # What names no spec is anyone's.
    file.write_text("/* nrs-design C header\n */")
    check_name("mine", file)
    file.write_text(text)
    check_name("mine", file)
    with pytest.raises(OutputError, match="was exported for the spec mine"):
        check_name("min", file)


def test_a_folder_is_no_certificate_of_another(folder):
    """It was "not a certificate (remove that file)"; where it is written it is called a folder."""
    check_certificate(folder / "specs/first.nrs.yaml", folder)
