"""Command line: parse, call the pipeline, print, exit code. No mathematics."""

from __future__ import annotations

import sys
import warnings

from nrs_design.cli import exit_codes

__all__ = ["main"]


def main() -> None:
    """Run the program; one that cannot even be loaded has found no verdict, and says so.

    A warning speaks about code, not about a spec: under ``-W error`` it is shown, but is no error.
    """
    if any(entry[0] == "error" for entry in warnings.filters):
        warnings.simplefilter("default")
    try:
        from nrs_design.cli.app import main as run
    except Exception as error:
        if sys.stderr:
            sys.stderr.write(f"internal error: nrs-design cannot be loaded: {error!a}\n")
        sys.exit(exit_codes.INTERNAL)
    run()
