"""The application: its commands, and what an error looks like."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from nrs_design import __version__
from nrs_design.cli import exit_codes
from nrs_design.cli.certify_switching import certify_switching
from nrs_design.cli.check import check
from nrs_design.cli.explain import explain
from nrs_design.cli.export import export
from nrs_design.cli.gate import gate
from nrs_design.cli.identify import app as identify
from nrs_design.cli.init import init
from nrs_design.cli.optimize import optimize
from nrs_design.cli.report import report
from nrs_design.cli.reproduce import reproduce
from nrs_design.cli.robot import robot
from nrs_design.cli.schema import schema
from nrs_design.cli.tune import tune
from nrs_design.cli.verify import verify
from nrs_design.errors import NrsDesignError

app = typer.Typer(
    name="nrs-design",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Design compliant controllers for surgical co-worker robots, and prove that switching "
    "between them is stable.",
    epilog="Exit codes: 0 proved or goal met, 1 refuted or goal missed, 2 wrong usage, spec or "
    "file, 3 inconclusive, 4 internal error.",
)
app.command("init")(init)
app.command("check")(check)
app.command("schema")(schema)
app.add_typer(identify, name="identify")
app.command("optimize")(optimize)
app.command("tune")(tune)
app.command("certify-switching")(certify_switching)
app.command("verify")(verify)
app.command("report")(report)
app.command("reproduce")(reproduce)
app.command("export")(export)
app.command("gate")(gate)
app.command("explain")(explain)
app.add_typer(robot)


def _show_version(requested: bool) -> None:
    if requested:
        typer.echo(f"nrs-design {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Hold the options of the program itself."""


def _open_closed_streams() -> None:
    """Give the program the streams that its caller has closed, so that it can print in vain."""
    nowhere = Path(os.devnull)
    sys.stdout = sys.stdout or nowhere.open("w")
    sys.stderr = sys.stderr or nowhere.open("w")


def _run() -> None:
    """Run the commands and flush, so that a verdict that was not delivered is no success.

    Click ends with exit code 1 when the reader of the output has gone: not our "refuted".
    """
    try:
        app()
    except SystemExit as end:
        if isinstance(end.__context__, BrokenPipeError):
            raise end.__context__ from None
        sys.stdout.flush()
        raise


def main() -> None:
    """Run the program; an error that the user can mend is one message and exit code 2."""
    _open_closed_streams()
    try:
        _run()
    except NrsDesignError as error:
        print(f"error[{error.rule}]: {error}", file=sys.stderr)
        sys.exit(exit_codes.USAGE)
    except OSError as error:
        # What could not be written must not be tried again at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        # Where the reader of our output has gone, there is nobody left to tell.
        if not isinstance(error, BrokenPipeError):
            print(f"error: the output cannot be written ({error.strerror})", file=sys.stderr)
        sys.exit(exit_codes.USAGE)
    except Exception as error:
        if "-v" in sys.argv or "--verbose" in sys.argv:
            import traceback

            traceback.print_exc()
        print(
            f"internal error: {type(error).__name__}: {error} (a defect of nrs-design, not a "
            "verdict; run again with -v and report what it prints)",
            file=sys.stderr,
        )
        sys.exit(exit_codes.INTERNAL)
