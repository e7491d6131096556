"""Prove a certificate in a process of its own while this one assembles the modes of the spec.

The proof of the modes that a certificate holds and the question whose modes they are need nothing
of each other (`nrs_design.certificates.verify`). On one processor, or where a process cannot be
copied cheaply, one follows the other. A process that ends without an answer has said nothing: the
proof is then checked here.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from threading import Thread
from typing import TYPE_CHECKING, Any

from nrs_design.certificates.prove import prove

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

    from nrs_design.certificates.verify import FindFault


@contextmanager
def proof_beside(document: Mapping[str, Any]) -> Iterator[FindFault | None]:
    """Begin to prove a document, and give what waits for the fault of it; None if it cannot begin.

    Parameters
    ----------
    document : mapping
        As `nrs_design.certificates.verify.read_document` gives it.
    """
    begun = _begin(document) if can_copy() else None
    if begun is None:
        yield None
        return
    process, receiver = begun

    def fault() -> str | None:
        try:
            told: str | None = receiver.recv()
        except (EOFError, OSError):
            # No answer, or a part of one. Whatever stopped it, stops this or is said here.
            return prove(document).fault
        return told

    try:
        yield fault
    finally:
        process.kill()
        process.join()
        receiver.close()


def _begin(document: Mapping[str, Any]) -> tuple[BaseProcess, Connection] | None:
    """Begin to prove a document; None without room for another process."""
    from multiprocessing import get_context

    context = get_context("fork")
    try:
        receiver, sender = context.Pipe(duplex=False)
        process = context.Process(target=_tell_fault, args=(document, sender), daemon=True)
        process.start()
    except OSError:
        return None
    sender.close()
    return process, receiver


def can_copy() -> bool:
    """Tell whether a copy of this process runs at the same time, and what it shares is safe."""
    return sys.platform == "linux" and len(os.sched_getaffinity(0)) > 1


def _tell_fault(document: Mapping[str, Any], sender: Connection) -> None:
    """Send the fault; an error is not sent, since it must be raised where it is seen."""
    # Who interrupts the program is answered by the other process, which ends this one.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, daemon=True).start()
    try:
        fault = prove(document).fault
    except Exception:
        return
    sender.send(fault)


def _end_with_parent() -> None:
    """End when nobody waits for an answer any more, however the other process was stopped."""
    from multiprocessing import parent_process

    if (parent := parent_process()) is not None:
        parent.join()
        os._exit(1)
