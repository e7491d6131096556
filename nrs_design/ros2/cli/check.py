"""``nrs-design ros2 check``: the parameters that a robot runs, against what it touches."""

from __future__ import annotations

import sys
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NoReturn

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import command
from nrs_design.cli.gate import GateFormat, format_of
from nrs_design.cli.options import read_work
from nrs_design.cli.printing import note, progress, say, say_failure, wants_text
from nrs_design.errors import NrsDesignError, SpecError
from nrs_design.ros2.law import LAG, ROTATIONAL, STIFFNESS, Range
from nrs_design.spec.quantity import QuantityKind, parse_quantity

if TYPE_CHECKING:
    from nrs_design.gating.obligations import GateOutcome

LONGEST_AGE = 20
Lag = Annotated[
    str,
    typer.Option(
        metavar="RANGE", help="Time constant with which the robot follows, such as '5..20 ms'."
    ),
]


@command("ros2-check")
def check(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="Parameter file, such as controllers.yaml.")
    ],
    stiffness: Annotated[
        str | None,
        typer.Option(metavar="RANGE", help="What translations touch, such as '200..2000 N/m'."),
    ] = None,
    rotational_stiffness: Annotated[
        str | None,
        typer.Option(metavar="RANGE", help="What rotations touch, such as '5..40 N*m/rad'."),
    ] = None,
    age: Annotated[
        str,
        typer.Option(metavar="RANGE", help="Age of the measured pose and force in periods: 1..3."),
    ] = "0",
    lag: Lag = "0 ms",
    budget: Annotated[
        float,
        typer.Option(
            metavar="WORK",
            parser=read_work,
            help="Work of the search of each axis, in units of about a second.",
        ),
    ] = 20.0,
    format_: Annotated[GateFormat, typer.Option("--format", help="What to print.")] = "text",
) -> NoReturn:
    """Prove or refute every axis of the admittance controllers in a parameter file.

    The law of admittance_controller (ros2_controllers) is taken as an exact difference equation at
    the update_rate of the file, with its force filter, for every stiffness in the range and every
    age of the measurement, changing at will. It warns of what does not do what it seems to.

    Exit code 0: all axes proved. 1: one refuted. 2: a parameter of the law is missing or
    wrong. 3: undecided; so is any other controller of the file that may move the robot.

    Example: nrs-design ros2 check docs/examples/admittance.ros2.yaml --stiffness '200..2000 N/m'

    Example: nrs-design ros2 check controllers.yaml --stiffness '0..900 N/m' --age 1..3
    """
    from nrs_design.gating.formats import FORMATS
    from nrs_design.ros2.axis import ControllerContext
    from nrs_design.ros2.check import check_file
    from nrs_design.search.certification import Limits

    output_format = format_of(format_)
    context = ControllerContext(
        _ages(age),
        range_of("--stiffness", stiffness, STIFFNESS),
        range_of("--rotational-stiffness", rotational_stiffness, ROTATIONAL),
        read_lag(lag),
    )
    with progress("checking") as step:
        outcome = check_file(file, context, Limits(budget=budget), step)
    if output_format != "text":
        sys.stdout.write(FORMATS[output_format](outcome))
    elif wants_text():
        _show(outcome)
    raise typer.Exit(exit_codes.SEVERITY_CODES[outcome.severity])


def _show(outcome: GateOutcome) -> None:
    """Print every axis, and below it what surprises people."""
    (found,) = outcome.specs
    for item in found.obligations:
        line = f"{item.path}:{item.line}: {item.status}: {item.message}"
        if item.fulfilled:
            say(line)
        else:
            say_failure(line, item.status)
    for caution in found.cautions:
        note(f"{found.path}:{caution.line}: warning: {caution.message}")
    if found.verdict is not None:
        say(f"{found.path}: {found.verdict.upper()}", verdict=found.verdict)
    for line in outcome.notes:
        say(f"  {line}")


def _ages(text: str) -> tuple[int, int]:
    low, _, high = text.partition("..")
    try:
        ages = int(low), int(high or low)
    except ValueError:
        raise NrsDesignError(
            f"--age: {text!r} is no range of periods", remedy="write --age 1 or --age 0..2"
        ) from None
    if not 0 <= ages[0] <= ages[1] <= LONGEST_AGE:
        raise NrsDesignError(
            f"--age: {text!r} does not rise from 0 to at most {LONGEST_AGE}",
            remedy="write --age 0..2",
        )
    return ages


def read_lag(text: str) -> Range:
    """Return the ends of a range of time constants in s."""
    return range_of("--lag", text, LAG) or (Fraction(0), Fraction(0))


def range_of(option: str, text: str | None, kind: QuantityKind) -> Range | None:
    """Read a range such as ``5..20 ms``, or a single quantity."""
    if text is None:
        return None
    remedy = f"write {option} '{kind.example}'"
    numbers, _, unit = text.partition(" ")
    low, _, high = numbers.partition("..")
    try:
        ends = [parse_quantity(f"{n} {unit}".strip(), kind).exact for n in (low, high or low)]
    except SpecError as error:
        raise NrsDesignError(f"{option}: {error.message}", remedy=remedy) from None
    if not 0 <= ends[0] <= ends[1]:
        raise NrsDesignError(
            f"{option}: {text!r} is not a rising range from zero or above", remedy=remedy
        )
    return ends[0], ends[1]
