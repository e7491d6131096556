import pytest

from nrs_design.cli.sweep import SWEPT
from tests.support import SOFT_TISSUE, document_of, run, spec_in

STIFFNESS = "environments.soft.stiffness"
# Proved, refuted.
TWO = f"{STIFFNESS}=700,2000 N/m"


@pytest.fixture
def spec(tmp_path):
    return spec_in(tmp_path, SOFT_TISSUE.read_text(encoding="utf-8"), "mine").name


def test_what_a_point_says_is_what_the_command_says(tmp_path, spec):
    swept = document_of("sweep", spec, "--set", TWO, "certify-switching", cwd=tmp_path, code=1)
    assert [point["values"] for point in swept["points"]] == [["700 N/m"], ["2000 N/m"]]
    text = (tmp_path / spec).read_text(encoding="utf-8")
    for point, value in zip(swept["points"], ("700", "2000"), strict=True):
        written = text.replace(
            "{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}", f"{value} N/m"
        )
        assert written != text
        (tmp_path / "written.nrs.yaml").write_text(written, encoding="utf-8")
        alone = document_of("certify-switching", "written.nrs.yaml", cwd=tmp_path)
        for attempt in alone["attempts"]:
            del attempt["seconds"]
        result = point["result"]
        assert result == {key: alone[key] for key in result}


def test_results_do_not_depend_on_how_many_processes_compute_them(tmp_path, spec):
    command = (
        "sweep", spec, "--set", f"{STIFFNESS}=700..2000/6 N/m", "certify-switching", "--json",
    )  # fmt: skip
    alone = run(*command, cwd=tmp_path, code=1)
    assert run(*command, "--jobs", 2, cwd=tmp_path, code=1).stdout == alone.stdout


def test_every_command_of_the_table_is_run(tmp_path):
    from nrs_design.cli.sweep_point import program_of

    for words in map(str.split, SWEPT):
        found = program_of(words[0])
        for word in words:
            found = found.commands[word]
        names = [parameter.name for parameter in found.params]
        assert {"spec", "specs"} & set(names)
        assert "as_json" in names
