"""Command line: parse, call the pipeline, print, exit code. No mathematics."""

from __future__ import annotations

import atexit
import gc
import sys
import warnings

from nrs_design.cli import exit_codes

__all__ = ["main"]

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
