import os

import pytest

from nrs_design.files import is_device_name, is_page, open_regular, unique_keys


def test_devices_of_windows():
    devices = ("nul", "NUL", "aux.csv", "com1.a.b", "lpt9", "con", "prn ")
    others = ("null", "console", "com", "com10", "a.nul", ".nul", "")
    assert [name for name in (*devices, *others) if is_device_name(name)] == [*devices]


def test_a_regular_file_is_read(tmp_path):
    (tmp_path / "a").write_bytes(b"a\r\n\x1a")
    with open_regular(tmp_path / "a") as file:
        assert file.read() == b"a\r\n\x1a"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes in folders")
def test_a_pipe_is_refused_and_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="not a regular file"):
        open_regular(tmp_path / "pipe")
    with pytest.raises(OSError, match="not a regular file"):
        open_regular(os.devnull)


def test_a_key_that_would_hide_another_is_refused():
    assert unique_keys([("a", 1), ("b", 2)]) == {"a": 1, "b": 2}
    with pytest.raises(ValueError, match="a key occurs twice"):
        unique_keys([("a", 1), ("a", 1)])


@pytest.mark.parametrize(
    "content", [b"<!DOCTYPE html>", b"\xef\xbb\xbf \n<HTML lang=en>", b"%PDF-1.7\n"]
)
def test_a_page_is_told_by_how_it_begins(content):
    assert is_page(content)
    assert not is_page(b"x" + content)
