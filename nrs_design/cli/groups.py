"""A group of commands that suggests the closest name, and reports wrong usage printably."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from typer.core import TyperGroup

from nrs_design.errors import NrsDesignError
from nrs_design.printable import printable


class CommandGroup(TyperGroup):
    """Command group that suggests the closest command name.

    Messages about arguments are made printable: a shell may have put a stranger's file name there.
    """

    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        """Read the arguments of the program."""
        with _printable_faults():
            return super().make_context(*args, **kwargs)

    def invoke(self, ctx: Any) -> Any:
        """Read the arguments of a command and run it."""
        with _printable_faults():
            return super().invoke(ctx)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Return the command that is named first."""
        known = self.list_commands(ctx)
        if not args[0].startswith("-") and args[0] not in known:
            raise NrsDesignError(
                f"there is no command {args[0]!r}", remedy=_suggestion(args[0], known)
            )
        return super().resolve_command(ctx, args)


@contextmanager
def _printable_faults() -> Iterator[None]:
    try:
        yield
    except Exception as error:
        # Wrong usage: the command-line library prints it.
        if hasattr(error, "format_message") and hasattr(error, "message"):
            # pydantic puts "Value error, " in front of our messages.
            error.message = printable(error.message).removeprefix("Value error, ")
            if "unexpected extra argument" in error.message and ".nrs.yaml" in error.message:
                error.message += ": one spec at a time; `nrs-design gate` takes several"
        raise


def _suggestion(word: str, known: Sequence[str]) -> str:
    """Suggest names that begin with the word, else names that resemble it."""
    begun = [name for name in known if len(word) > 1 and name.startswith(word.lower())]
    near = begun or difflib.get_close_matches(word.lower(), known, n=2)
    return f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(known)}"
