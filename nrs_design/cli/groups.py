"""Groups of commands: what is said where there is no such command, or it is used wrongly."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from typer.core import TyperGroup

from nrs_design.errors import NrsDesignError
from nrs_design.printable import printable


class CommandGroup(TyperGroup):
    """Commands, of which one is suggested where none is named.

    What is wrong with their arguments is said in printable words: an argument may be a stranger's
    file name that a shell has put there.
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
        """Return the command that is named first.

        Raises
        ------
        NrsDesignError
            If there is none of that name.
        """
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
        # Wrong usage, which the command-line library prints itself.
        if hasattr(error, "format_message") and hasattr(error, "message"):
            # What checks a value puts its own name in front of what is wrong with it.
            error.message = printable(error.message).removeprefix("Value error, ")
        raise


def _suggestion(word: str, known: Sequence[str]) -> str:
    """Take the beginning of a name for a slip, before names that look alike."""
    begun = [name for name in known if len(word) > 1 and name.startswith(word.lower())]
    near = begun or difflib.get_close_matches(word.lower(), known, n=2)
    return f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(known)}"
