"""The application: its commands, and what an error looks like."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Callable, Iterable
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from nrs_design import __version__
from nrs_design.cli import exit_codes
from nrs_design.cli.printing import insist, print_json
from nrs_design.cli.streams import lasting
from nrs_design.errors import ClockError, NrsDesignError
from nrs_design.printable import printable
from nrs_design.wings import load_wing, wing_of

# The module of a command, here or in a wing, has the name of the command. The help lists groups and
# commands in this order.
GROUPS = {
    "Start": ("init", "identify", "check", "explain", "schema"),
    "Design": ("optimize", "tune", "mode-logic", "simulate"),
    "Prove": ("certify-switching", "verify", "sweep", "compare-methods"),
    "Ship": ("report", "gate", "export", "diff", "audit"),
    "Robot": ("robot", "ros2", "reproduce"),
}
COMMANDS = tuple(name for names in GROUPS.values() for name in names)
_PANELS = {name: panel for panel, names in GROUPS.items() for name in names}

# Libraries read these environment variables at import. Users cannot override them, so that no
# verdict depends on the environment.
SETTINGS = {
    # Several threads add in varying order, so sums would round differently from run to run.
    "OPENBLAS_NUM_THREADS": "1",
    # No other package takes part in reading specs.
    "PYDANTIC_DISABLE_PLUGINS": "__all__",
}


class CommandGroup(TyperGroup):
    """Commands whose messages about arguments are printable: a shell may put a file name there."""

    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        """Read the arguments of the program."""
        return _printably(super().make_context, *args, **kwargs)

    def invoke(self, ctx: Any) -> Any:
        """Read the arguments of a command and run it."""
        return _printably(super().invoke, ctx)


def _printably(call: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
    try:
        return call(*args, **kwargs)
    except Exception as error:
        # Wrong usage: the command-line library prints it.
        if hasattr(error, "format_message") and hasattr(error, "message"):
            # pydantic puts "Value error, " in front of our messages.
            error.message = printable(error.message).removeprefix("Value error, ")
            _print_as_json(NrsDesignError(printable(error.format_message())))
        raise


def _print_as_json(error: NrsDesignError) -> None:
    """Print an error where JSON is wanted, whether or not the command was read."""
    if "--json" in sys.argv:
        from nrs_design.cli.errors import error_summary

        print_json("error", error_summary(error))


def make_app(names: Iterable[str] = COMMANDS) -> typer.Typer:
    """Build the application with some of its commands; only these are imported."""
    app = typer.Typer(
        name="nrs-design",
        cls=CommandGroup,
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},
        help="Design compliant controllers for surgical co-worker robots, and prove that switching "
        "between them is stable.",
        epilog="Exit codes: 0 proved or goal met, 1 refuted or goal missed, 2 wrong usage, spec or "
        "file, 3 inconclusive, 4 internal error.",
    )
    app.callback()(_root)
    for name in names:
        attribute, wing = name.replace("-", "_"), wing_of(name)
        if wing is None:
            module = import_module(f"nrs_design.cli.{attribute}")
        else:
            try:
                module = load_wing(wing, f"cli.{attribute}")
            except NrsDesignError as error:
                _refuse(app, name, error)
                continue
        command = getattr(module, attribute)
        if isinstance(command, typer.Typer):
            app.add_typer(command, name=name, rich_help_panel=_PANELS[name])
        else:
            settings = getattr(command, "settings", None)
            app.command(name, context_settings=settings, rich_help_panel=_PANELS[name])(command)
    return app


def _refuse(app: typer.Typer, name: str, error: NrsDesignError) -> None:
    """Add a command that only says that its wing is missing."""
    anything = {"ignore_unknown_options": True, "allow_extra_args": True, "help_option_names": []}

    @app.command(name, help=f"({error.message})", context_settings=anything)
    def refuse() -> None:
        raise error


def _show_version(requested: bool) -> None:
    if requested:
        typer.echo(f"nrs-design {__version__}")
        raise typer.Exit


def _root(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Print the version."),
    ] = False,
    verbose: Annotated[
        bool, typer.Option("--verbose", "-v", help="Show where an internal error arose.")
    ] = False,
) -> None:
    """Hold the options of the program itself."""


def _run() -> None:
    """Run the command and flush stdout, so that an undelivered verdict is not a success."""
    command_names = sys.argv[1:2]
    app = make_app(command_names if set(command_names) & set(COMMANDS) else COMMANDS)
    try:
        app()
    finally:
        sys.stdout.flush()


def main() -> None:
    """Run the program; report a user error in one message with exit code 2."""
    os.environ.update(SETTINGS)
    if not sys.warnoptions:
        # Warnings of libraries are for programmers.
        warnings.simplefilter("ignore")
    sys.stdout, sys.stderr = lasting(sys.stdout), lasting(sys.stderr)
    try:
        _run()
    except NrsDesignError as error:
        from nrs_design.cli.errors import print_error

        _print_as_json(error)
        print_error(error)
        stopped = isinstance(error, ClockError)
        sys.exit(exit_codes.INCONCLUSIVE if stopped else exit_codes.USAGE)
    except OSError as error:
        # At exit, Python must not write the remaining output again.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        # Standard output has no name.
        failed = "the output cannot be written"
        if error.filename is not None:
            failed = f"{printable(error.filename)} cannot be read or written"
        insist(f"error: {failed} ({error.strerror})")
        sys.exit(exit_codes.USAGE)
    except MemoryError:
        # Said where less is loaded.
        raise
    except Exception as error:
        if "-v" in sys.argv or "--verbose" in sys.argv:
            import traceback

            for line in traceback.format_exc().split("\n"):
                insist(line)
        insist(
            f"internal error: {type(error).__name__}: {error} (a defect of nrs-design, not a "
            "verdict; run it again as `nrs-design -v ...` and report what that prints)"
        )
        sys.exit(exit_codes.INTERNAL)
