"""Command line: parse, call the pipeline, print, exit code. No mathematics."""

from __future__ import annotations

import atexit
import gc
import sys
import warnings
from typing import NoReturn

from nrs_design.cli import exit_codes

__all__ = ["main"]

# Imports make many objects that stay until the end: to look at them takes as long as a short proof.
COLLECT_AFTER = 200_000
# Address space in bytes that OpenBLAS needs; with less, it ends the process with code 1.
LEAST_MEMORY = 512 * 2**20


def main() -> None:
    """Run the program; exit with code 4 if it cannot be loaded, and with 130 after Ctrl-C.

    Under ``-W error`` warnings are shown, but do not end the program: they are about code, not
    about a spec.
    """
    gc.set_threshold(COLLECT_AFTER)
    atexit.register(gc.freeze)
    if any(entry[0] == "error" for entry in warnings.filters):
        warnings.simplefilter("default")
    try:
        _refuse_little_memory()
        try:
            from nrs_design.cli.app import main as run
        except Exception as error:
            if isinstance(error, MemoryError):
                raise
            _end(f"internal error: nrs-design cannot be loaded: {error!a}", exit_codes.INTERNAL)
        run()
    except KeyboardInterrupt:
        # An interrupt may also fall into an import.
        sys.exit(exit_codes.INTERRUPTED)
    except MemoryError:
        _end("error: there is not enough memory (allow more)", exit_codes.USAGE)


def _refuse_little_memory() -> None:
    """End where numerical libraries would end the program themselves, as if a spec were refuted."""
    if sys.platform == "win32":
        return
    import resource

    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    if 0 <= limit < LEAST_MEMORY:
        available, required = limit // 2**20, LEAST_MEMORY // 2**20
        message = (
            f"{available} MiB of memory are allowed, and {required} MiB are needed (ulimit -v)"
        )
        _end(f"error: {message}", exit_codes.USAGE)


def _end(message: str, code: int) -> NoReturn:
    if sys.stderr:
        sys.stderr.write(f"{message}\n")
    sys.exit(code)
