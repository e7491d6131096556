"""The command line on a terminal."""

import fcntl
import os
import pty
import struct
import sys
import termios
from pathlib import Path


def run_on_terminal(
    columns: int, *arguments: str | Path, cwd: Path, **environment: str
) -> tuple[str, int]:
    """Run a command on a terminal of a width; return what it shows, and its exit code."""
    process, screen = pty.fork()
    if process == 0:
        os.chdir(cwd)
        os.environ.pop("NO_COLOR", None)
        os.environ |= {"TERM": "xterm", "COLUMNS": str(columns), **environment}
        fcntl.ioctl(1, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
        os.execv(sys.executable, [sys.executable, "-m", "nrs_design", *map(str, arguments)])
    shown = b""
    try:
        while part := os.read(screen, 65536):
            shown += part
    except OSError:
        # How a terminal says that nobody writes to it any more.
        pass
    os.close(screen)
    return shown.decode(), os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
