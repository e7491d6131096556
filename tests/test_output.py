import os
import stat
import threading
from pathlib import Path

import pytest

from nrs_design.errors import OutputError
from nrs_design.gating.formats.text import COLUMNS
from nrs_design.output import (
    CERTIFICATE,
    GATE,
    PAGE,
    PNG,
    RESPONSE,
    SCHEMA,
    SVG,
    check_html,
    check_place,
    lock_folder,
    write_output,
    write_outputs,
)
from nrs_design.spec.schema import schema_text

XML = '<?xml version="1.0" encoding="utf-8" standalone="no"?>\n'
RUN = "time_s,angle_rad,velocity_rad_s,torque_Nm"
JUNIT = '<?xml version="1.0" encoding="UTF-8"?>\n<testsuites name="{}" tests="1">'
SARIF = (
    '{{\n  "$schema": "https://json.schemastore.org/sarif-2.1.0.json",\n  "version": "2.1.0",\n'
    '  "runs": [\n    {{\n      "tool": {{\n        "driver": {{\n          "name": "{}",'
)
# The first two chunks of an image of one point: what it is like, and who says that it made it.
FOREIGN_PNG = b"\x89PNG\r\n\x1a\n" + bytes.fromhex(
    "0000000d49484452000000010000000108000000003a7e9b55"
)
OUR_PNG = FOREIGN_PNG + b"\0\0\0\x13tEXtSoftware\0nrs-design"


@pytest.mark.parametrize(
    ("content", "data"), [("é\n", "é\n".encode()), (b"\x00\xff", b"\x00\xff"), ("", b"")]
)
def test_text_and_bytes(tmp_path, content, data):
    path = tmp_path / "new" / "folder" / "out"
    write_output(path, content)
    assert path.read_bytes() == data
    assert stat.S_IMODE(path.stat().st_mode) == 0o644
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("place", ["link/out", "link/new/out", "real/link/out", "link/../out"])
@pytest.mark.parametrize("absolute", [True, False])
def test_nothing_is_written_behind_a_link_to_a_folder(tmp_path, monkeypatch, place, absolute):
    """A repository could otherwise lead `reports` to any place."""
    for name in ("outside", "work", "work/real"):
        (tmp_path / name).mkdir()
    for link in ("work/link", "work/real/link"):
        (tmp_path / link).symlink_to(tmp_path / "outside")
    (tmp_path / "outside/out").write_text("precious")
    monkeypatch.chdir(tmp_path / "work")
    path = tmp_path / "work" / place if absolute else Path(place)
    with pytest.raises(OutputError, match=r"behind the symbolic link .*link") as caught:
        write_output(path, "new")
    assert caught.value.remedy == "name the folder that it leads to, or remove the link"
    assert [p.name for p in (tmp_path / "outside").iterdir()] == ["out"]
    assert (tmp_path / "outside/out").read_text() == "precious"


def test_a_working_folder_behind_a_link_is_the_users_own_choice(tmp_path, monkeypatch):
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    monkeypatch.chdir(tmp_path / "link")
    write_output(Path("reports/out"), "new")
    assert (tmp_path / "real/reports/out").read_text() == "new"


@pytest.mark.parametrize(
    ("kind", "ours", "foreign"),
    [
        (CERTIFICATE, '{\n  "schema": "nrs-design/certificate/9"', '{"schema": "other"}'),
        (PAGE, f"{PAGE.decode()}<title>", "<!DOCTYPE html>\n<html>"),
        (PNG, OUR_PNG, FOREIGN_PNG),
        (SVG, f"{XML}<!-- nrs-design figure -->\n<svg/>", f"{XML}<svg/>"),
        (GATE, '{\n  "schema": "nrs-design/gate/1"', '{\n  "schema": "nrs-design/lock/1"'),
        (GATE, "::error file=a,line=1,col=1,title=NRS101::no", "::error file=a::no title=NRS101::"),
        (GATE, JUNIT.format("nrs-design"), JUNIT.format("pytest tests")),
        (GATE, SARIF.format("nrs-design"), SARIF.format("ruff")),
        (GATE, f"{'  '.join(COLUMNS)}\n---", "spec  1 of the project\n"),
        (RESPONSE, f"{RUN},depth_rad,reference_rad,hand_rad_s,theta_rad,mode\n", f"{RUN},mode\n"),
        (SCHEMA, schema_text(), "kind: switched-system"),
    ],
)
def test_only_a_file_of_its_kind_is_replaced(tmp_path, kind, ours, foreign):
    path = tmp_path / "out"
    write_output(path, ours, replaces=kind)
    write_output(path, ours, replaces=kind)
    write_output(path, foreign)
    before = path.read_bytes()
    with pytest.raises(OutputError, match="not overwritten"):
        write_output(path, ours, replaces=kind)
    assert path.read_bytes() == before


@pytest.mark.parametrize("fault", ["foreign", "link", "full"])
def test_of_files_that_belong_together_all_are_written_or_none(tmp_path, monkeypatch, fault):
    paths = [tmp_path / f"new/{name}" for name in "abc"]
    write_outputs([(path, "ours 1", b"ours") for path in paths])
    write_outputs([(path, "ours 2", b"ours") for path in paths])
    before = dict.fromkeys(paths, "ours 2")
    if fault == "foreign":
        paths[2].write_text("precious")
        before[paths[2]] = "precious"
    elif fault == "link":
        paths[2].unlink()
        paths[2].symlink_to(paths[0])
    else:
        calls = iter(range(3))
        chmod = os.chmod

        def fail(*arguments):
            if next(calls) == 2:
                raise OSError(28, "No space left on device")
            chmod(*arguments)

        monkeypatch.setattr(os, "chmod", fail)
    with pytest.raises(OutputError):
        write_outputs([(path, "ours 3", b"ours") for path in paths])
    assert {path: path.read_text() for path in (tmp_path / "new").iterdir()} == before


def test_an_empty_file_holds_nothing_that_could_be_lost(tmp_path):
    path = tmp_path / "out"
    path.touch()
    write_output(path, "::error", replaces=GATE)
    assert path.read_text() == "::error"


@pytest.mark.parametrize(
    ("step", "error", "raised"),
    [
        ("replace", OSError(28, "No space left on device"), OutputError),
        ("chmod", OSError(28, "No space left on device"), OutputError),
        ("replace", KeyboardInterrupt(), KeyboardInterrupt),
    ],
)
def test_failure_leaves_what_there_was(tmp_path, monkeypatch, step, error, raised):
    path = tmp_path / "out"
    path.write_text("old")

    def fail(*arguments):
        raise error

    monkeypatch.setattr(os, step, fail)
    with pytest.raises(raised, match="No space left" if raised is OutputError else None):
        write_output(path, "new")
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_text() == "old"


def test_a_file_name_that_is_no_text_is_written_with_escapes(tmp_path):
    write_output(tmp_path / "a", "from b\udcff")
    assert (tmp_path / "a").read_bytes() == rb"from b\udcff"


@pytest.mark.parametrize(
    ("name", "said"),
    [
        *((name, "device on Windows") for name in ("nul", "AUX.html", "com1.cert.json")),
        ("file/page.html", r"cannot be written \(Not a directory\)"),
        *((name, "symbolic link") for name in ("link", "dead link")),
        ("file", "not overwritten"),
        # A program that runs as root could otherwise replace a device by a file.
        *((name, "a folder or a device") for name in (".", "pipe")),
    ],
)
def test_a_place_is_refused_before_the_work_as_it_would_be_after_it(tmp_path, name, said):
    (tmp_path / "file").write_text("precious")
    (tmp_path / "link").symlink_to(tmp_path / "file")
    (tmp_path / "dead link").symlink_to(tmp_path / "nowhere")
    os.mkfifo(tmp_path / "pipe")
    place = tmp_path / name
    before = sorted(tmp_path.iterdir())
    with pytest.raises(OutputError, match=said) as first:
        check_place(place, PAGE)
    with pytest.raises(OutputError) as last:
        write_output(place, "page", replaces=PAGE)
    assert str(first.value) == str(last.value)
    assert last.value.path == place
    assert sorted(tmp_path.iterdir()) == before
    assert (tmp_path / "file").read_text() == "precious"
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_a_folder_that_cannot_be_written_to_is_refused_before_the_work(tmp_path, monkeypatch):
    """The tests may run as root, who can write anywhere."""
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(OutputError, match=r"Permission denied.*choose a writable folder"):
        check_place(tmp_path / "a/page.html", PAGE)


def test_two_who_change_one_file_take_turns(tmp_path):
    file = tmp_path / "a" / "count"

    def add() -> None:
        for _ in range(20):
            with lock_folder(file.parent):
                count = int(file.read_text()) if file.exists() else 0
                write_output(file, str(count + 1))

    threads = [threading.Thread(target=add) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert file.read_text() == "40"


def test_a_place_that_is_free_stays_as_it_is(tmp_path):
    check_place(tmp_path / "a/b/page.html", PAGE)
    assert list(tmp_path.iterdir()) == []


def test_a_page_is_what_its_name_ends_in():
    for name in ("a.html", "a.htm", "a.HTM"):
        check_html(Path(name))
    for name in ("page.png", "page.pdf", "page"):
        with pytest.raises(OutputError, match="not the name of a page in HTML"):
            check_html(Path(name))


def test_two_files_of_one_name_are_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(OutputError, match="is named for two files"):
        write_outputs([(Path("a"), "one", b""), (tmp_path / "a", "two", b"")])
    assert not list(tmp_path.iterdir())
