"""Commands of the user: a compiler, an emulator. No shell, a time limit, all they say kept."""

from __future__ import annotations

import os
import shlex
import shutil
import signal
import subprocess
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryFile

from nrs_design.errors import NrsDesignError

# Of each command; a self-test takes a second on an emulator.
SECONDS = 120.0
# What is kept of what a command says: its end.
_MOST_BYTES = 2**16


@dataclass(frozen=True, slots=True)
class Done:
    """What a command has done."""

    code: int
    said: str  # On both streams


def words_of(line: str, option: str) -> tuple[str, ...]:
    """Split a command line as a shell does, and run none.

    Parameters
    ----------
    line : str
        As typed.
    option : str
        That it was given to.

    Raises
    ------
    NrsDesignError
        If a quote does not end, or nothing is there.
    """
    try:
        words = tuple(shlex.split(line))
    except ValueError as error:
        raise NrsDesignError(
            f"{option} {line!r} is no command line: {error}", remedy="close every quote"
        ) from error
    if not words:
        raise NrsDesignError(f"{option} is empty", remedy="name a program and its arguments")
    return words


def run_command(words: Sequence[str], folder: Path, option: str, seconds: float = SECONDS) -> Done:
    """Run a command in a folder, with nothing to read; it and what it started end with its time.

    Parameters
    ----------
    words : sequence of str
        Program and arguments.
    folder : Path
        Where it runs.
    option : str
        That it was given to, for errors.
    seconds : float
        How long it may take.

    Raises
    ------
    NrsDesignError
        If it cannot be run, or takes longer.
    """
    program = shutil.which(words[0])
    if program is None:
        raise NrsDesignError(
            f"{option}: there is no program {words[0]!r} here",
            remedy="install it, or name it with its path",
        )
    with TemporaryFile() as said:
        try:
            process = subprocess.Popen(
                words,
                # Seen from where the user is, not from the folder.
                executable=Path(program).absolute(),
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        except OSError as error:
            raise NrsDesignError(
                f"{option}: {words[0]} cannot be run here ({error.strerror})",
                remedy="a program for another processor needs --run, such as an emulator",
            ) from error
        try:
            code = process.wait(seconds)
        except subprocess.TimeoutExpired as error:
            raise NrsDesignError(
                f"{option}: {words[0]} has not ended after {seconds:g} s",
                remedy="see whether it waits for something; it gets no input",
            ) from error
        finally:
            _end(process)
        said.seek(max(said.seek(0, os.SEEK_END) - _MOST_BYTES, 0))
        return Done(code, said.read().decode(errors="replace"))


def _end(process: subprocess.Popen[bytes]) -> None:
    """End a command, and what it has left running."""
    if hasattr(os, "killpg"):
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    else:
        process.kill()
    process.wait()
