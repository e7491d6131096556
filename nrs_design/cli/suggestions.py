"""What is meant by a command that does not exist."""

from __future__ import annotations

import difflib
from collections.abc import Sequence
from typing import Any

from typer.core import TyperGroup

from nrs_design.errors import NrsDesignError


class SuggestingGroup(TyperGroup):
    """A group of commands that suggests one where none is named."""

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


def _suggestion(word: str, known: Sequence[str]) -> str:
    """Take the beginning of a name for a slip, before names that look alike."""
    begun = [name for name in known if len(word) > 1 and name.startswith(word.lower())]
    near = begun or difflib.get_close_matches(word.lower(), known, n=2)
    return f"did you mean {' or '.join(near)}?" if near else f"there are {', '.join(known)}"
