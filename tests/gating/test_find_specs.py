from pathlib import Path

import pytest

from nrs_design.errors import NrsDesignError, SpecError
from nrs_design.gating.find_specs import find_misnamed, find_passed_over, find_specs
from tests.tables import rows


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    root = tmp_path / "specs"
    for name in ("b.nrs.yaml", "a/z.nrs.yaml", "a/y.yaml", ".venv/x.nrs.yaml", "c.nrs.yaml.bak"):
        file = root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    return root


def test_folder_means_all_specs_below_it_sorted_without_hidden_ones(folder):
    assert find_specs([folder]) == (folder / "a/z.nrs.yaml", folder / "b.nrs.yaml")


def test_a_spec_named_twice_is_listed_once(folder):
    assert find_specs([folder / "a", folder, folder / "a/../a/z.nrs.yaml"]) == find_specs([folder])


def test_an_empty_folder_is_refused(tmp_path):
    with pytest.raises(NrsDesignError, match=r"no \*\.nrs\.yaml") as caught:
        find_specs([tmp_path])
    assert caught.value.path == tmp_path


def test_links_to_folders_are_not_followed(folder, tmp_path):
    (tmp_path / "outside").mkdir()
    (tmp_path / "outside/o.nrs.yaml").touch()
    (folder / "link").symlink_to(tmp_path / "outside")
    (folder / "loop").symlink_to(folder)
    assert len(find_specs([folder])) == 2


def test_a_link_to_a_spec_outside_is_refused(folder, tmp_path):
    (tmp_path / "o.nrs.yaml").touch()
    (folder / "o.nrs.yaml").symlink_to(tmp_path / "o.nrs.yaml")
    with pytest.raises(SpecError, match="out of the folder"):
        find_specs([folder])


@pytest.mark.parametrize("name", ["c.nrs.yml", "C.NRS.YAML", "c.Nrs.Yml", ".c.nrs.yaml"])
def test_other_endings_are_specs_too(folder, name):
    (folder / name).touch()
    assert folder / name in find_specs([folder])


def test_what_is_passed_over(folder, tmp_path):
    (tmp_path / "outside").mkdir()
    (folder / "link").symlink_to(tmp_path / "outside")
    (folder / ".venv/.deeper").mkdir()
    (folder / "a/.hidden").mkdir()
    expected = (folder / ".venv", folder / "a/.hidden", folder / "link")
    assert find_passed_over([folder]) == expected
    assert find_passed_over([folder / "b.nrs.yaml", folder / "missing"]) == ()


def test_specs_by_another_name_are_listed(tmp_path):
    spec = "# first a comment\nkind: robot\nname: a\n"
    (tmp_path / "good.nrs.yaml").write_text(spec)
    (tmp_path / "arm.yaml").write_text(spec)
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "ARM.YML").write_bytes(b"\xff\nkind: switched-system\n")
    (tmp_path / "pod.yaml").write_text("kind: robotics\nspec: {}\n")
    (tmp_path / "notes.txt").write_text(spec)
    (tmp_path / "gone.yaml").symlink_to(tmp_path / "nowhere")
    assert find_misnamed([tmp_path]) == (tmp_path / "arm.yaml", tmp_path / "inner" / "ARM.YML")
    assert find_misnamed([tmp_path / "arm.yaml"]) == ()


@pytest.mark.parametrize(
    "text",
    [
        *rows(__file__, "test_a_kind_is_found_however_it_is_written"),
        "#" + 40_000 * " " + "\nkind: robot\n",
        40_000 * "\n" + "kind: robot\n",
    ],
)
@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_a_kind_is_found_however_it_is_written(tmp_path, text, encoding):
    (tmp_path / "arm.yaml").write_text(text, encoding=encoding)
    assert find_misnamed([tmp_path]) == (tmp_path / "arm.yaml",)


@pytest.mark.parametrize("text", rows(__file__, "test_what_is_no_kind_of_a_spec"))
def test_what_is_no_kind_of_a_spec(tmp_path, text):
    (tmp_path / "arm.yaml").write_text(text)
    assert find_misnamed([tmp_path]) == ()
