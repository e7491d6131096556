"""Foreign files are read by a process of their own, which can hurt nobody but itself.

Libraries that read files of other programs follow what a file says: a stranger's may crash them,
or make them fill the memory. So they run in a child with limits, which sends back plain values. Its
answer is data from a stranger, too: nothing in it is unpickled or run, its size is limited, and it
must be of the type that the reader declares to return.

`nrs_design.confined_child` is the other side.
"""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Timer
from typing import Any, BinaryIO, TypeVar, get_type_hints

from nrs_design.errors import DataError, NrsDesignError

# Of memory, beyond what the libraries take themselves: three copies of the longest record.
MEMORY = 2 << 30
# Of a processor, in s: so many for any file, and so many for each MiB of it. A sheet of 30 MB takes
# minutes; a file that is short and takes long is none that a measurement has left.
SECONDS, SECONDS_PER_MEBIBYTE = 30, 20
# Of time that passes, in s, for each of these: the machine may have other work. A last fuse.
PATIENCE = 4
# Of an answer, in bytes: its arrays, and the text that says where they belong.
LARGEST_ARRAYS, LARGEST_HEAD = 1 << 30, 1 << 26
# Types of numbers, text and time in NumPy; objects are none of them.
_PLAIN = re.compile(r"[<>|=][biufcSUmM]\d{1,9}(\[\w{1,9}\])?")
_LONGEST_MESSAGE = 1000
_MOST_AXES = 32
# What a system needs to start a program; nothing else of the environment is passed on.
_ENVIRONMENT = ("PATH", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "SYSTEMROOT", "LANG", "LC_ALL")
_SETTINGS = {
    # One thread: each would reserve memory of its own, which counts.
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "MALLOC_ARENA_MAX": "1",
    "ARROW_DEFAULT_MEMORY_POOL": "system",
    "PYDANTIC_DISABLE_PLUGINS": "__all__",
}
_CHILD = """\
import json, sys
order = json.loads(sys.argv[1])
sys.path += [place for place in order["places"] if place not in sys.path]
from nrs_design.confined_child import main
main(order)
"""
_SAVE_ANEW = "save it anew, or as CSV"
T = TypeVar("T")


def read_confined(
    reader: Callable[[BinaryIO, Path], T],
    libraries: Sequence[str],
    file: BinaryIO,
    path: Path,
    remedy: str = _SAVE_ANEW,
) -> T:
    """Read a file in a process of its own.

    Parameters
    ----------
    reader : callable
        Function of a module, called there with the file at its beginning and its path. What it
        returns is made of dicts, lists, texts, numbers, bytes and arrays of numbers or text; an
        answer that is not of its annotated type is refused.
    libraries : sequence of str
        Modules that it needs, which are imported before limits are set.
    file : binary file
        A regular one, opened. The child shares its position, so it is not read here afterwards.
    path : Path
        For errors.
    remedy : str
        What to do if it cannot be read, where the reader does not say.

    Returns
    -------
    object
        What the reader has returned.

    Raises
    ------
    DataError
        That of the reader, or one that says how the child ended, if it gave no answer.
    """
    os.lseek(file.fileno(), 0, os.SEEK_SET)
    mebibytes = os.fstat(file.fileno()).st_size >> 20
    seconds = SECONDS + SECONDS_PER_MEBIBYTE * mebibytes
    order = {
        "reader": f"{reader.__module__}:{reader.__name__}",
        "libraries": list(libraries),
        "path": str(path),
        "parent": os.getpid(),
        "memory": MEMORY,
        "seconds": seconds,
        "places": _places(),
    }
    with _child(order, file, PATIENCE * seconds) as child:
        try:
            told, value = answer_of(child)
            if told == "value":
                return _typed(reader, value)
        except (ValueError, TypeError, KeyError, RecursionError, MemoryError):
            child.kill()
            raise _ended(child.wait(), seconds, path, remedy) from None
    message, advice = value
    raise DataError(message, path=path, remedy=advice or remedy)


def _typed(reader: Callable[[BinaryIO, Path], T], value: Any) -> T:
    """Return a value as the type that a reader declares; lists become its tuples.

    Raises
    ------
    ValueError
        If it is of another type.
    """
    from pydantic import ConfigDict, TypeAdapter

    # An array only has to be one: `_PLAIN` decides what it may hold.
    config = ConfigDict(arbitrary_types_allowed=True)
    adapter: TypeAdapter[T] = TypeAdapter(get_type_hints(reader)["return"], config=config)
    return adapter.validate_python(value)


def _places() -> list[str]:
    """Return where the child finds what this process would import, whichever folder it is in."""
    own = str(Path(__file__).parent.parent)
    return [*filter(os.path.isabs, sys.path), own]


@contextmanager
def _child(
    order: dict[str, Any], file: BinaryIO, patience: float
) -> Iterator[subprocess.Popen[bytes]]:
    """Start a child in an empty folder; it is gone, and the folder too, at the end."""
    environment = {name: os.environ[name] for name in _ENVIRONMENT if name in os.environ}
    with TemporaryDirectory(prefix="nrs-design-") as folder:
        try:
            child = subprocess.Popen(
                # Isolated: neither the folder nor the environment says what is imported.
                [sys.executable, "-I", "-B", "-c", _CHILD, json.dumps(order)],
                stdin=file.fileno(),
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                cwd=folder,
                env=environment | _SETTINGS,
            )
        except OSError as error:
            raise NrsDesignError(
                f"the process that reads it cannot be started ({error.strerror})",
                path=Path(order["path"]),
                remedy="free memory, or let fewer programs run at once",
            ) from error
        fuse = Timer(patience, child.kill)
        fuse.daemon = True
        fuse.start()
        try:
            yield child
        finally:
            fuse.cancel()
            child.kill()
            child.wait()
            assert child.stdout is not None
            child.stdout.close()


def _ended(code: int, seconds: int, path: Path, remedy: str) -> DataError:
    """Return the error of a file whose reader gave no answer, or none that can be used."""
    names = {-number: number.name for number in signal.Signals}
    if code == -getattr(signal, "SIGXCPU", 0):
        why = f"reading it took more than {seconds} s of a processor"
    elif code == -getattr(signal, "SIGKILL", 0):
        # By the fuse, by the system for want of memory, or by us for what it said.
        why = f"reading it took too much memory, more than {PATIENCE * seconds} s, or gave nonsense"
    elif code < 0:
        why = f"reading it crashed the library that does so ({names.get(code, code)})"
    else:
        why = f"reading it ended without an answer (exit code {code})"
    return DataError(f"{why}: it is damaged or hostile", path=path, remedy=remedy)


def answer_of(child: subprocess.Popen[bytes]) -> tuple[str, Any]:
    """Return what a child has told.

    Raises
    ------
    ValueError, TypeError, KeyError, RecursionError
        If that is no answer, or none that is allowed.
    """
    assert child.stdout is not None
    head = child.stdout.readline(LARGEST_HEAD)
    if not head.endswith(b"\n"):
        with suppress(subprocess.TimeoutExpired):
            child.wait(1)
        raise ValueError
    said = json.loads(head)
    if not isinstance(said, dict):
        raise TypeError
    ((told, value),) = said.items()
    if told == "fault":
        message, advice = value
        if not isinstance(message, str) or not isinstance(advice, str | None):
            raise TypeError
        return told, (message[:_LONGEST_MESSAGE], advice and advice[:_LONGEST_MESSAGE])
    if told != "value":
        raise ValueError
    return told, _decoded(value, _Raw(child.stdout))


class _Raw:
    """The bytes behind the head of an answer, which are not endless."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream
        self._left = LARGEST_ARRAYS

    def take(self, length: int) -> bytearray:
        if type(length) is not int:
            raise TypeError
        self._left -= length
        if length < 0 or self._left < 0:
            raise ValueError
        found = bytearray(length)
        if self._stream.readinto(found) < length:
            raise ValueError
        return found


def _decoded(node: Any, raw: _Raw) -> Any:
    """Return a value of its description: what is no object of JSON stands for itself."""
    if not isinstance(node, dict):
        if isinstance(node, list):
            raise TypeError
        return node
    ((kind, held),) = node.items()
    return _KINDS[kind](held, raw)


def _array(held: Any, raw: _Raw) -> Any:
    import numpy as np

    kind, shape = held
    if not _PLAIN.fullmatch(kind) or len(shape) > _MOST_AXES:
        raise ValueError
    if any(type(n) is not int or n < 0 for n in shape):
        raise TypeError
    dtype = np.dtype(kind)
    length = dtype.itemsize
    for n in shape:
        length *= n
    found = np.frombuffer(raw.take(length), dtype).reshape(shape)
    if dtype.kind == "U" and found.size:
        # NumPy takes any four bytes for a character, and fails where such a text is read.
        codes = found.reshape(-1).view(np.dtype("u4").newbyteorder(dtype.byteorder))
        if codes.max() > sys.maxunicode:
            raise ValueError
    return found


_KINDS: dict[str, Callable[[Any, _Raw], Any]] = {
    "list": lambda held, raw: [_decoded(item, raw) for item in held],
    "dict": lambda held, raw: {str(key): _decoded(item, raw) for key, item in held},
    "complex": lambda held, raw: complex(*map(float, held)),
    "bytes": lambda held, raw: bytes(raw.take(held)),
    "array": _array,
}


def encoded(value: Any, parts: list[bytes | memoryview]) -> Any:
    """Return the description of a value, and add the bytes that belong to it; see `_decoded`.

    Parameters
    ----------
    value : object
        As `read_confined` says.
    parts : list
        What stands behind the description.

    Raises
    ------
    TypeError
        If it is something else.
    """
    if value is None or isinstance(value, str | bool | int | float):
        return value
    if isinstance(value, complex):
        return {"complex": [value.real, value.imag]}
    if isinstance(value, bytes):
        parts.append(value)
        return {"bytes": len(value)}
    if isinstance(value, dict):
        return {"dict": [[str(key), encoded(item, parts)] for key, item in value.items()]}
    if isinstance(value, list | tuple):
        return {"list": [encoded(item, parts) for item in value]}
    kind = value.dtype.str if hasattr(value, "dtype") else ""
    if not _PLAIN.fullmatch(kind):
        raise TypeError(f"it holds a value of the type {kind or type(value).__name__}")
    parts.append(value.tobytes())
    return {"array": [kind, list(value.shape)]}
