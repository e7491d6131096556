"""A command returns an answer; one printer shows it as text or JSON, and ends with its code."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from contextvars import copy_context
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.exit_codes import worst
from nrs_design.cli.printing import output, print_json, wants_details, wants_json, wants_text
from nrs_design.errors import NrsDesignError

if TYPE_CHECKING:
    from nrs_design.spec import LoadedSpec

VERBOSE = "Print what the short answer leaves out."
QUIET = "Print nothing but errors, and what --json, --format or --out ask for; see the exit code."
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout.")]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help=VERBOSE)]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help=QUIET)]


def _nothing() -> None:
    """Show no text."""


@dataclass(frozen=True, slots=True)
class Answer:
    """Result of a command."""

    facts: Callable[[], dict[str, Any]] = dict  # Content of the JSON document
    print_text: Callable[[], object] = _nothing  # Prints the result as text
    code: int = exit_codes.PROVED
    loud: bool = False  # True for an error, which --quiet does not silence

    def deliver(self, name: str) -> None:
        """Print what is wanted, and end with the exit code."""
        if wants_json():
            print_json(name, self.facts())
        else:
            self.tell()
        raise typer.Exit(self.code)

    def tell(self) -> None:
        """Print the result as text; under --quiet, print errors only."""
        if self.loud or wants_text():
            with output(as_json=False, quiet=False, verbose=wants_details()):
                self.print_text()


def command(
    name: str, *, has_json: bool = True, each_axis: bool = False, forwards_options: bool = False
) -> Callable[[Callable[..., Answer]], Callable[..., None]]:
    """Make a command of a function: with --json, -v and -q, and an end that prints its answer.

    `each_axis`: it is run for each axis of a `spec` that holds several. `passes_on`: options that
    it does not know belong to its last argument.
    """
    options = {"verbose": Verbose, "quiet": Quiet}
    options |= {"as_json": Json} if has_json else {}

    def decorate(function: Callable[..., Answer]) -> Callable[..., None]:
        @wraps(function)
        def run(
            *, as_json: bool = False, quiet: bool = False, verbose: bool = False, **arguments: Any
        ) -> None:
            def answer() -> None:
                with output(as_json=as_json, quiet=quiet, verbose=verbose):
                    found = (
                        _for_each_axis(function, arguments) if each_axis else function(**arguments)
                    )
                    found.deliver(name)

            # A command must not change the axis of the next command.
            copy_context().run(answer)

        signature = inspect.signature(function, eval_str=True)
        keyword = inspect.Parameter.KEYWORD_ONLY
        added = [
            inspect.Parameter(n, keyword, default=False, annotation=options[n]) for n in options
        ]
        parameters = (*signature.parameters.values(), *added)
        # Typer keeps the line breaks of all paragraphs but the first.
        paragraphs = (inspect.getdoc(function) or "").split("\n\n")
        run.__doc__ = "\n\n".join(" ".join(text.split()) for text in paragraphs)
        vars(run)["__signature__"] = signature.replace(parameters=parameters)
        vars(run)["settings"] = {"ignore_unknown_options": forwards_options}
        run.__annotations__ = {p.name: p.annotation for p in parameters}
        return run

    return decorate


def take_spec(path: Path) -> LoadedSpec:
    """Read a spec, and say everything until the end of the command about its axis."""
    from nrs_design.models.axis import take
    from nrs_design.spec import read_spec

    loaded = read_spec(path)
    take(getattr(loaded.spec, "axis", None))
    return loaded


def _for_each_axis(function: Callable[..., Answer], arguments: dict[str, Any]) -> Answer:
    """Answer for each axis of a spec in turn, and end with the worst of the codes."""
    from nrs_design.spec.load import axes_at

    spec = arguments["spec"]
    axes = axes_at(spec)
    if axes == (spec,):
        return function(**arguments)
    if arguments.get("out") is not None:
        raise NrsDesignError(
            "one file is not enough for several axes",
            path=spec,
            remedy=f"leave --out out, or name one axis, such as {axes[0]}",
        )
    answers: dict[str, dict[str, Any]] = {}
    codes = set()
    for axis in axes:
        answer = function(**arguments | {"spec": axis})
        codes.add(answer.code)
        if wants_json():
            answers[str(axis)] = answer.facts()
        else:
            answer.tell()
    return Answer(lambda: {"axes": answers}, code=worst(codes))
