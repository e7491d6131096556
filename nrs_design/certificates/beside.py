"""Prove a certificate in a process of its own while this one assembles the modes of the spec.

The proof of the modes that a certificate holds and the question whose modes they are need nothing
of each other (`nrs_design.certificates.verify`). On one processor, or where a process cannot be
copied cheaply, one follows the other. A process that ends without an answer has said nothing: the
proof is then checked here.

The copy and the pipes are made by hand: to load `multiprocessing` takes as long as a tenth of the
proof.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from threading import Thread
from typing import TYPE_CHECKING, Any, NoReturn

from nrs_design.certificates.prove import prove

if TYPE_CHECKING:
    from nrs_design.certificates.verify import FindFault

# Of an answer, read at once.
PART = 2**16


@contextmanager
def proof_beside(document: Mapping[str, Any]) -> Iterator[FindFault | None]:
    """Begin to prove a document, and give what waits for its fault; None if it cannot begin."""
    begun = _begin(document) if can_copy() else None
    if begun is None:
        yield None
        return
    process, answer, hold = begun

    def fault() -> str | None:
        try:
            told: str | None = json.loads(_read_all(answer))
        except ValueError:
            # No answer, or a part of one. Whatever stopped it, stops this or is said here.
            return prove(document).fault
        return told

    try:
        yield fault
    finally:
        # Where nobody wants to know of children that end, it is gone when it has ended, and its
        # number may be that of another process.
        with suppress(ProcessLookupError, ChildProcessError):
            if os.waitpid(process, os.WNOHANG) == (0, 0):
                os.kill(process, signal.SIGKILL)
                os.waitpid(process, 0)
        os.close(answer)
        os.close(hold)


def _begin(document: Mapping[str, Any]) -> tuple[int, int, int] | None:
    """Begin to prove a document; None without room for another process.

    Returns the process, where its answer is read, and what is open as long as this process lives.
    """
    pipes: list[int] = []
    try:
        pipes += os.pipe()
        pipes += os.pipe()
        process = os.fork()
    except OSError:
        for pipe in pipes:
            os.close(pipe)
        return None
    answer, tell, life, hold = pipes
    if process == 0:
        os.close(answer)
        os.close(hold)
        _tell_fault(document, tell, life)
    os.close(tell)
    os.close(life)
    return process, answer, hold


def can_copy() -> bool:
    """Tell whether a copy of this process runs at the same time, and what it shares is safe."""
    return sys.platform == "linux" and len(os.sched_getaffinity(0)) > 1


def _tell_fault(document: Mapping[str, Any], tell: int, life: int) -> NoReturn:
    """Send the fault and end; an error is not sent, since it must be raised where it is seen."""
    try:
        # Who interrupts the program is answered by the other process, which ends this one.
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        Thread(target=_end_with_parent, args=(life,), daemon=True).start()
        told = json.dumps(prove(document).fault).encode()
        while told:
            told = told[os.write(tell, told) :]
    finally:
        # Nothing of the other process is done a second time at the end of this one.
        os._exit(0)


def _end_with_parent(life: int) -> None:
    """End when nobody waits for an answer any more, however the other process was stopped."""
    # Nobody writes: it is read when the other end is closed.
    os.read(life, 1)
    os._exit(1)


def _read_all(pipe: int) -> bytes:
    """Read until the other end is closed."""
    parts = []
    while part := os.read(pipe, PART):
        parts.append(part)
    return b"".join(parts)
