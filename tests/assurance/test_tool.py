import hashlib
import tomllib

from nrs_design.assurance import tool
from tests.support import ROOT

COUNTS = {"mutants": 100, "killed": 97, "equivalent": 3, "unnoticed": 0}


def test_every_file_that_decides_is_listed_with_lines_and_hash():
    found = tool.decider()
    paths = sorted((ROOT / "nrs_design" / "proof").rglob("*.py"))
    assert [file.path for file in found.files] == [
        path.relative_to(ROOT / "nrs_design").as_posix() for path in paths
    ]
    exact = next(file for file in found.files if file.path == "proof/exact.py")
    content = (ROOT / "nrs_design/proof/exact.py").read_bytes()
    assert exact.lines == len(content.splitlines())
    assert exact.sha256 == hashlib.sha256(content).hexdigest()
    assert found.lines == sum(len(path.read_bytes().splitlines()) for path in paths)
    assert found.imports == ("flint",)


def test_what_is_believed_beside_it_is_counted():
    lines = sum(
        len(path.read_bytes().splitlines()) for path in (ROOT / "nrs_design/spec").rglob("*.py")
    )
    assert tool.decider().believed["reads the spec"] == lines
    folders = {name for names in tool.BELIEVED.values() for name in names}
    assert all((ROOT / "nrs_design" / name).is_dir() for name in folders)


def test_a_record_is_read_back(monkeypatch, tmp_path):
    path = tmp_path / "mutation.toml"
    monkeypatch.setattr(tool, "MUTATION", path)
    assert tool.decider().mutation is None
    tool.keep_record(COUNTS)
    found = tool.decider()
    assert found.examined
    assert found.mutation == tool.MutationRecord(found.sha256, **COUNTS)
    path.write_text(path.read_text().replace(found.sha256, "0" * 64))
    assert tomllib.loads(path.read_text())["killed"] == 97
    assert not tool.decider().examined
