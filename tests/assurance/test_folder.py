import os

import pytest

from nrs_design.assurance.contents import sums_of
from nrs_design.assurance.folder import check_free, hash_faults, read_folder, write_folder
from nrs_design.errors import CertificateError, OutputError

NAME = "commuting"


def test_a_folder_holds_what_its_hashes_list(folder):
    assert hash_faults(read_folder(folder)) == ()


def test_hashes_are_as_sha256sum_writes_them():
    assert sums_of({"b": b"", "a": b"abc"}) == (
        b"ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  a\n"
        b"e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  b\n"
    )


def test_one_changed_byte_is_found_in_every_file(matrices_folder):
    files = read_folder(matrices_folder)
    for path in files.keys() - {"SHA256SUMS"}:
        changed = {**files, path: files[path] + b"\n"}
        assert hash_faults(changed) == (f"{path!r} was changed",)


def test_what_is_missing_or_added_is_named(matrices_folder):
    files = read_folder(matrices_folder)
    more = {**files, "note.txt": b""}
    del more["hazards.md"]
    assert hash_faults(more) == ("'hazards.md' is missing", "'note.txt' was added")
    del more["SHA256SUMS"]
    assert hash_faults(more) == ("SHA256SUMS is missing",)
    assert hash_faults({**files, "SHA256SUMS": b"x\n"}) == (
        "SHA256SUMS has a line that is no hash and name",
    )


def test_a_link_in_a_folder_is_refused(folder):
    (folder / "hazards.md").unlink()
    os.symlink("/etc/hostname", folder / "hazards.md")
    with pytest.raises(CertificateError, match="is a symbolic link"):
        read_folder(folder)


def test_a_new_an_empty_and_an_old_folder_of_the_spec_are_free(tmp_path, folder):
    assert check_free(tmp_path / "new", NAME) == ()
    (tmp_path / "empty").mkdir()
    assert check_free(tmp_path / "empty", NAME) == ()
    assert "README.md" in check_free(folder, NAME)


def changed(folder):
    (folder / "hazards.md").write_text("mine")


def added(folder):
    (folder / "note.txt").write_text("mine")


def foreign(folder):
    for path in folder.iterdir():
        if path.is_file():
            path.unlink()
    (folder / "thesis.tex").write_text("mine")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (changed, "'hazards.md' was changed"),
        (added, "'note.txt' was added"),
        (foreign, "something else than evidence"),
    ],
)
def test_nothing_of_the_user_is_overwritten(folder, change, said):
    change(folder)
    before = read_folder(folder)
    with pytest.raises(OutputError, match=said):
        write_folder(folder, NAME, {"README.md": b"new"})
    assert read_folder(folder) == before


def test_evidence_of_another_spec_stays(folder):
    with pytest.raises(OutputError, match="evidence of the spec 'commuting'"):
        check_free(folder, "other")


def test_what_a_newer_folder_lacks_is_removed(folder):
    contents = {"README.md": b"new", "SHA256SUMS": b""}
    write_folder(folder, NAME, contents)
    assert read_folder(folder) == contents


def test_a_folder_of_more_than_evidence_is_refused(folder):
    with (folder / "disk.img").open("wb") as file:
        file.truncate(2**28 + 1)
    with pytest.raises(CertificateError, match="holds more than evidence does"):
        read_folder(folder)


def test_a_file_has_one_hash_alone():
    """The first of two would be told as wrong by sha256sum, and nobody looked at it."""
    digest = "2d711642b726b04401627ca9fbac32f5c8530fb1903cc4db02258717921a4881"  # Of x
    right, wrong = f"{digest}  a\n", f"{'0' * 64}  a\n"
    assert hash_faults({"a": b"x", "SHA256SUMS": right.encode()}) == ()
    twice = {"a": b"x", "SHA256SUMS": f"{wrong}{right}".encode()}
    assert hash_faults(twice) == ("SHA256SUMS names a file twice",)
