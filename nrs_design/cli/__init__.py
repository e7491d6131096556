"""Command line: parse, call the pipeline, print, exit code. No mathematics."""

from __future__ import annotations

import atexit
import gc
import os
import sys
import warnings
from contextlib import suppress

from nrs_design.cli import exit_codes

__all__ = ["main", "program"]

# Imports make many objects that stay until the end, so the collector need not look at them.
COLLECT_AFTER = 200_000


def main() -> None:
    """Run the program; exit with code 4 if it cannot be loaded.

    Under ``-W error`` warnings are shown, but do not end the program: they are about code, not
    about a spec.
    """
    gc.set_threshold(COLLECT_AFTER)
    # At the end there is nothing worth collecting.
    atexit.register(gc.freeze)
    if any(entry[0] == "error" for entry in warnings.filters):
        warnings.simplefilter("default")
    try:
        from nrs_design.cli.app import main as run
    except Exception as error:
        if sys.stderr:
            sys.stderr.write(f"internal error: nrs-design cannot be loaded: {error!a}\n")
        sys.exit(exit_codes.INTERNAL)
    run()


def program() -> None:
    """Run the program as a process of its own, and end it without tearing down libraries.

    Tearing them down takes longer than checking a certificate. Exit handlers of others run before.
    """
    code: int | None = None

    def end() -> None:
        with suppress(OSError, ValueError):
            sys.stderr.flush()
            sys.stdout.flush()
            if code is not None:
                os._exit(code)

    # Registered first, so called last.
    atexit.register(end)
    try:
        main()
    except SystemExit as ending:
        if ending.code is None or isinstance(ending.code, int):
            code = ending.code or 0
        raise
