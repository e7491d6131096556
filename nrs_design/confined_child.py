"""The process that reads a foreign file: what it may do, and how it answers.

It has the open file as its standard input, an empty folder, and no variable of the environment
beyond what a program needs to start. Limits of the system hold for whatever a library does; they
are set behind its import, which is as long as it is, whatever the file says. On Windows there are
none, and on macOS none of memory: there, the clock of the other process ends this one.
"""

from __future__ import annotations

import json
import os
import signal
import sys
import time
import warnings
from contextlib import suppress
from importlib import import_module
from math import ceil
from pathlib import Path
from typing import Any

from nrs_design.confined import encoded
from nrs_design.errors import DataError

# Of Linux: a network, and a set of users, of one's own.
_NEW_NETWORK, _NEW_USERS = 0x40000000, 0x10000000
_SIGNAL_AT_DEATH_OF_PARENT = 1
# What Python asks about before it does so. No reader has to do with other programs or machines,
# nor changes a file.
_REFUSED = (
    *("socket.", "subprocess.", "os.fork", "os.posix_spawn", "os.exec", "os.system", "os.spawn"),
    *("os.startfile", "os.kill", "os.remove", "os.rename", "os.truncate", "os.mkdir", "os.rmdir"),
    *("os.link", "os.symlink", "os.chmod", "os.chown", "os.utime", "shutil."),
)
_WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
# Open files beyond the standard ones; a library may look up a font or a time zone.
_OPEN_FILES = 64


def main(order: dict[str, Any]) -> None:
    """Read what is at the standard input, answer, and end.

    Parameters
    ----------
    order : dict
        ``reader``, ``libraries``, ``path``, ``parent``, ``memory`` in bytes and ``seconds`` of a
        processor.
    """
    # Whatever a library prints is no answer.
    answer = os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    end_with(order["parent"])
    leave_network()
    warnings.simplefilter("ignore")
    module, _, function = order["reader"].partition(":")
    reader = getattr(import_module(module), function)
    for library in order["libraries"]:
        # One that is missing is told by the reader, in its own words.
        with suppress(ImportError):
            import_module(library)
    set_limits(order["memory"], order["seconds"])
    sys.addaudithook(refuse)
    parts: list[bytes | memoryview] = []
    told = "value"
    try:
        with open(0, "rb", closefd=False) as file:
            value = encoded(reader(file, Path(order["path"])), parts)
    except MemoryError:
        parts.clear()
        told = "fault"
        value = [f"takes more than {order['memory'] >> 20} MiB of memory to read", None]
    except Exception as error:
        parts.clear()
        told = "fault"
        value = _fault(error)
    answer.write(json.dumps({told: value}).encode() + b"\n")
    for part in parts:
        answer.write(part)
    answer.flush()
    # What libraries want done at the end is of no use to anybody.
    os._exit(0)


def _fault(error: Exception) -> list[str | None]:
    if isinstance(error, DataError):
        return [error.message, error.remedy]
    lines = str(error).strip().splitlines()
    return [f"cannot be read ({(lines[0] if lines else type(error).__name__)[:200]})", None]


def end_with(parent: int) -> None:
    """End with the process that asks, even if that is killed: on Linux, the system sees to it."""
    if sys.platform != "linux":
        return
    import ctypes

    ctypes.CDLL(None).prctl(_SIGNAL_AT_DEATH_OF_PARENT, int(signal.SIGKILL))
    # It may have ended before.
    if os.getppid() != parent:
        os._exit(1)


def leave_network() -> bool:
    """Go where there is no network, for good; return whether the system lets this process do so.

    Linux does for an administrator, and for others where it lets them have users of their own.
    """
    if sys.platform != "linux":
        return False
    import ctypes

    system = ctypes.CDLL(None)
    return any(system.unshare(kind) == 0 for kind in (_NEW_NETWORK, _NEW_NETWORK | _NEW_USERS))


def set_limits(memory: int, seconds: int) -> None:
    """Let the system end this process when it takes more, and let it write no file.

    Parameters
    ----------
    memory : int
        In bytes, beyond what is taken by now.
    seconds : int
        Of a processor, beyond what is taken by now.
    """
    try:
        import resource
    except ImportError:
        return
    taken = 0
    with suppress(OSError):
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
        taken = pages * resource.getpagesize()
    limits = {
        resource.RLIMIT_AS: taken + memory,
        resource.RLIMIT_CPU: ceil(time.process_time()) + seconds,
        resource.RLIMIT_FSIZE: 0,
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_NOFILE: _OPEN_FILES,
    }
    for kind, most in limits.items():
        # At the first of the two times, the signal says which limit it was.
        last = most + 5 * (kind == resource.RLIMIT_CPU)
        # A system that does not know a limit refuses it, and one that has a lower one keeps it.
        with suppress(ValueError, OSError):
            resource.setrlimit(kind, (most, last))


def refuse(event: str, arguments: tuple[object, ...]) -> None:
    """Refuse what no reader needs, as the hook that Python asks.

    Raises
    ------
    PermissionError
        If it is about other programs, other machines or the files of others.
    """
    opens_to_write = event == "open" and bool(int(str(arguments[2] or 0)) & _WRITING)
    if opens_to_write or event.startswith(_REFUSED):
        raise PermissionError(f"{event} is not for readers of files")
