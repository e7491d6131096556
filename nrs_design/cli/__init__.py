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

# Objects made before the collector looks for garbage: what imports make stays until the end.
COLLECT_AFTER = 200_000


def main() -> None:
    """Run the program; one that cannot even be loaded has found no verdict, and says so.

    A warning speaks about code, not about a spec: under ``-W error`` it is shown, but is no error.
    """
    gc.set_threshold(COLLECT_AFTER)
    # Nor is what is left at the end worth a search for garbage.
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
    """Run the program as a process of its own, which ends at once when its work is done.

    To take libraries down piece by piece takes longer than to check a certificate, and the system
    takes all of it back anyway. What others want done at the end is done before.
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
