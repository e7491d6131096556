"""What every format of the table keeps."""

import shutil
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from nrs_design.controllers.shipped import shipped_law
from nrs_design.errors import DesignError
from nrs_design.exporters import format_names, format_of, rendered
from nrs_design.exporters.export import Execution, export_design
from tests.support import ROOT, SOFT_TISSUE


@pytest.fixture(params=["sampled", "continuous"])
def design(request):
    return request.getfixturevalue(request.param)


@pytest.fixture
def proved(request, design):
    kind = "continuous" if design.spec.sampling is None else "sampled"
    return request.getfixturevalue(f"{kind}_export")


def exported(name, design, proved):
    if not format_of(name).executable or proved.record.sample_time is not None:
        return proved
    return export_design(design, execution=Execution(Fraction(2, 1000), unproved=True))


@pytest.mark.parametrize("name", [name for name in format_names() if format_of(name).executable])
def test_names_that_are_none_in_c_are_refused_by_every_program(name, sampled_export, monkeypatch):
    from nrs_design.exporters import program

    def twice(*arguments):
        return replace(shipped_law(*arguments), modes=("a-b", "a.b"))

    monkeypatch.setattr(program, "shipped_law", twice)
    with pytest.raises(DesignError, match="same name in C"):
        rendered(name, sampled_export)


@pytest.mark.parametrize("name", format_names())
def test_every_file_is_of_the_table_and_the_same_each_time(name, design, proved):
    export = exported(name, design, proved)
    files = rendered(name, export)
    assert set(files) == set(format_of(name).files)
    for ending, content in files.items():
        beginning = format_of(name).files[ending]
        assert beginning
        assert content.startswith(beginning)
        assert ".." not in Path(ending).parts
        assert Path(f"x{ending}").parts[0].startswith("x")
    assert rendered(name, export) == files


@pytest.mark.parametrize("name", format_names())
def test_every_file_says_what_it_is_worth(name, design, proved):
    export = exported(name, design, proved)
    record = export.record
    facts = [record.spec.sha256, record.proof.certificate_id, *record.outside]
    facts += [record.sample_time.exact] if record.sample_time else []
    facts += [record.unproved] if record.unproved else []
    for content in rendered(name, export).values():
        text = " ".join(content.decode(errors="replace").replace("*", " ").split())
        assert [fact for fact in facts if fact not in text] == []


NEW = '''
"""Gains in one line each."""

from nrs_design.exporters import DESIGN, Format
from nrs_design.exporters.export import Export

FORMAT = Format("gains in one line each", DESIGN, {".gains.txt": b"# gains of "})


def render(export: Export) -> dict[str, bytes]:
    record = export.shipped()
    lines = [f"{c.name} {g.name} {g.exact}" for c in record.controllers for g in c.gains]
    text = "\\n".join([f"# gains of {record.spec.name}", *lines])
    return {".gains.txt": text.encode()}
'''


@pytest.mark.slow
def test_a_new_format_is_one_file(tmp_path):
    """Added to a copy of the package, and used as a user would."""
    shutil.copytree(ROOT / "nrs_design", tmp_path / "nrs_design")
    (tmp_path / "nrs_design/exporters/formats/gains.py").write_text(NEW)
    command = [sys.executable, "-m", "nrs_design", "export", SOFT_TISSUE, "--format", "gains"]
    done = subprocess.run(
        [*command, "--out", "."], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "soft-tissue.gains.txt").read_text().splitlines()
    assert lines[0] == "# gains of soft-tissue"
    assert len(lines) == 5
