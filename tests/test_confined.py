"""The process that reads foreign files: what it may do, and what is taken from it."""

import io
import json
import os
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from nrs_design import confined
from nrs_design.arrays.files import unpack_npz
from nrs_design.confined import encoded, read_confined
from nrs_design.errors import DataError
from nrs_design.identification.foreign import read_npz, unpack_sheet
from tests import foreign_readers
from tests.support import ROOT

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="limits of other systems are others")


@pytest.fixture
def read(tmp_path):
    def call(reader, content=b"content"):
        path = tmp_path / "file.mat"
        path.write_bytes(content)
        with path.open("rb") as file:
            return read_confined(getattr(foreign_readers, reader), (), file, path)

    return call


def test_plain_values_come_back(read, tmp_path, monkeypatch):
    """From an empty folder, without the environment; no module of the working folder is loaded."""
    (tmp_path / "numpy.py").write_text("import evil\n")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SECRET", "token")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    found = read("told")
    array, words = found.pop("array"), found.pop("words")
    np.testing.assert_array_equal(array, [[0, 1, 2], [3, 4, 5]])
    assert words.tolist() == ["a", "bc"]
    assert found == {
        "all": b"content",
        "numbers": [1, 2.5, True, None, 1 + 2j, "text"],
        "folder": [],
        "secret": None,
        "places": [],
        "modules": [],
        "path": str(tmp_path / "file.mat"),
    }


def test_what_is_printed_is_no_answer(read):
    assert read("print_much") == "answer"


@LINUX
@pytest.mark.parametrize(
    ("reader", "said"),
    [
        ("crash", r"crashed the library that does so \(SIGABRT\)"),
        ("memory", "takes more than 2048 MiB of memory"),
        ("leave", "ended without an answer"),
        ("pickled", "holds a value of the type"),
        ("write", "open is not for readers"),
        ("outside", "open is not for readers"),
        ("remove", "os.remove is not for readers"),
        ("program", "subprocess.Popen is not for readers"),
        ("fork", "os.fork is not for readers"),
        ("network", "socket.* is not for readers"),
    ],
)
def test_a_file_that_does_harm_is_one_message(read, tmp_path, reader, said):
    with pytest.raises(DataError, match=said) as caught:
        read(reader)
    assert caught.value.path == tmp_path / "file.mat"
    assert caught.value.remedy
    assert os.listdir(tmp_path) == ["file.mat"]
    assert all(part.read_bytes() in (b"content", b"") for part in tmp_path.iterdir())


@LINUX
def test_time_of_a_processor_and_time_that_passes_are_limited(read, monkeypatch):
    monkeypatch.setattr(confined, "SECONDS", 1)
    # On a machine that does other work, too.
    monkeypatch.setattr(confined, "PATIENCE", 60)
    start = time.monotonic()
    with pytest.raises(DataError, match="more than 1 s of a processor"):
        read("processor")
    monkeypatch.setattr(confined, "PATIENCE", 2)
    with pytest.raises(DataError, match="more than 2 s"):
        read("sleep")
    assert time.monotonic() - start < 60


def test_an_answer_has_a_limit(read, monkeypatch):
    assert read("large").size == 1 << 24
    monkeypatch.setattr(confined, "LARGEST_ARRAYS", (1 << 24) - 1)
    with pytest.raises(DataError, match="gave nonsense"):
        read("large")


ANSWERS = {
    "nothing": b"",
    "no JSON": b"{",
    "deep": b"[" * 100_000,
    "another word": b'{"verdict": "proved"}',
    "two words": b'{"value": 1, "fault": ["a", null]}',
    "an unknown kind": b'{"value": {"pickle": "x"}}',
    "a bare list": b'{"value": [1]}',
    "no bytes behind": b'{"value": {"bytes": 10}}',
    "a negative length": b'{"value": {"bytes": -1}}',
    "objects": b'{"value": {"array": ["|O", [1]]}}',
    "a structure": b'{"value": {"array": ["i4,O", [1]]}}',
    "an endless array": b'{"value": {"array": ["<f8", [1000000000, 1000000000]]}}',
    "a negative axis": b'{"value": {"array": ["<f8", [-1]]}}',
    "many axes": json.dumps({"value": {"array": ["<f8", [0] * 1000]}}).encode(),
    "no object": b"[1]",
    "an infinite length": b'{"value": {"bytes": 1e999}}',
    "a text of no characters": b'{"value": {"array": ["<U1", [1]]}}\n\xff\xff\xff\xff',
    "an object as a message": b'{"fault": [{}, null]}',
}


@pytest.fixture
def pretend(monkeypatch, tmp_path):
    """Let a child that is no Python of ours give an answer."""

    def call(answer, read):
        (tmp_path / "answer.npz").write_bytes(answer)
        started = subprocess.Popen

        def answered(command, *, stdin, stdout, **_):
            return started(["cat", str(tmp_path / "answer.npz")], stdin=stdin, stdout=stdout)

        monkeypatch.setattr(confined.subprocess, "Popen", answered)
        with (tmp_path / "answer.npz").open("rb") as file:
            return read(file, tmp_path / "answer.npz")

    return call


@LINUX
@pytest.mark.parametrize("case", ANSWERS)
def test_an_answer_that_is_none_is_one_message(pretend, case):
    """What a taken process may say."""
    with pytest.raises(DataError, match="hostile"):
        pretend(ANSWERS[case] + b"\n", partial(read_confined, foreign_readers.told, ()))


def described(*values):
    parts = []
    return json.dumps({"value": encoded(values, parts)}).encode() + b"\n" + b"".join(parts)


@LINUX
@pytest.mark.parametrize("reader", [read_npz, unpack_sheet, unpack_npz])
@pytest.mark.parametrize(
    "answer",
    [b'{"value": 5}\n', described(), described(5, 5), described({"a": 3j}, {"b": [1j]})],
)
def test_an_answer_of_another_type_is_one_message(pretend, reader, answer):
    with pytest.raises(DataError, match="hostile"):
        pretend(answer, partial(read_confined, reader, ()))


@LINUX
@pytest.mark.slow
def test_the_child_ends_with_the_command_that_is_killed(tmp_path):
    program = (
        "from pathlib import Path\nfrom nrs_design.confined import read_confined\n"
        "from tests.foreign_readers import sleep\n"
        f"file = Path({str(tmp_path / 'file.mat')!r})\nfile.write_bytes(b'')\n"
        "read_confined(sleep, (), file.open('rb'), file)\n"
    )
    with subprocess.Popen([sys.executable, "-c", program], cwd=ROOT) as command:
        children = Path(f"/proc/{command.pid}/task/{command.pid}/children")
        deadline = time.monotonic() + 20
        while not (found := children.read_text().split()) and time.monotonic() < deadline:
            time.sleep(0.05)
        (child,) = found
        # It has said so to the system once it is in a network of its own, or could not go there.
        time.sleep(1)
        command.kill()
    while (alive := Path(f"/proc/{child}").exists()) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not alive


def test_a_long_message_is_cut(monkeypatch):
    answer = json.dumps({"fault": ["a" * 10**6, "b" * 10**6]}).encode() + b"\n"

    class Child:
        stdout = io.BytesIO(answer)

    told, (message, remedy) = confined.answer_of(Child())
    assert (told, len(message), len(remedy)) == ("fault", 1000, 1000)


def test_only_plain_values_are_sent():
    parts = []
    assert encoded({"a": (1, b"xy")}, parts) == {"dict": [["a", {"list": [1, {"bytes": 2}]}]]}
    assert parts == [b"xy"]
    for value in (object(), {1, 2}, np.array([{}]), np.zeros(1, [("a", "i4")])):
        with pytest.raises(TypeError, match="a value of the type"):
            encoded(value, parts)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_without_a_network_there_is_no_way_out(tmp_path):
    """Where the system lets a process leave it, native code reaches no machine, either."""
    look = (
        "from nrs_design.confined_child import leave_network\n"
        "left = leave_network()\n"
        "import socket\n"
        "names = [name for _, name in socket.if_nameindex()]\n"
        "print(left, names)\n"
    )
    done = subprocess.run([sys.executable, "-c", look], capture_output=True, text=True, check=True)
    left, _, names = done.stdout.strip().partition(" ")
    assert left == "False" or names in ("['lo']", "[]")
