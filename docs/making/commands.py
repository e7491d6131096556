"""Every command with its arguments and options, as ``--help`` has them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import typer
from typer.cli import get_docs_for_click

from making.faults import refuse
from nrs_design.cli.app import make_app


def commands_page(command: Any = None) -> str:
    """Describe every command, of the program by default."""
    command = command or typer.main.get_command(make_app())
    refuse("commands, arguments or options without help", silent(command, "nrs-design"))
    context = typer.Context(command, info_name="nrs-design")
    text = get_docs_for_click(obj=command, ctx=context, name="nrs-design")
    return f"# Commands\n\n{text.partition(chr(10))[2]}"


def silent(command: Any, name: str) -> Iterator[str]:
    """Yield the names of commands and parameters that say nothing of themselves."""
    if not (command.help or "").strip():
        yield name
    for parameter in command.params:
        if not getattr(parameter, "help", None):
            yield f"{name} {parameter.name}"
    for inner, one in getattr(command, "commands", {}).items():
        yield from silent(one, f"{name} {inner}")
