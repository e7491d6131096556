"""What every format of the table keeps."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from nrs_design.controllers.shipped import shipped_law
from nrs_design.errors import DesignError
from nrs_design.exporters import format_names, format_of, rendered
from nrs_design.exporters.export import Execution, export_design


@pytest.fixture(params=["sampled", "continuous"])
def design(request):
    return request.getfixturevalue(request.param)


@pytest.fixture
def proved(request, design):
    kind = "continuous" if design.spec.sampling is None else "sampled"
    return request.getfixturevalue(f"{kind}_export")


def exported(name, design, proved):
    """The export of a design, proved or not, as the format takes it."""
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
        assert Path(f"x{ending}").name == f"x{ending}"
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
