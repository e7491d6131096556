"""``nrs-design check-lyapunov``: the exact verdict on anybody's P."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import say

if TYPE_CHECKING:
    from fractions import Fraction

    from nrs_design.api.lyapunov import Counterexample, LyapunovCheck
    from nrs_design.proof.mode import Time

_LAW = {"continuous": "x' = A x", "discrete": "x+ = A x"}
# What must be negative, by time and whether a rate is asked for.
_CHANGE = {
    ("continuous", False): "x' (A'P + PA) x",
    ("continuous", True): "x' (A'P + PA + 2 alpha P) x",
    ("discrete", False): "x' (A'PA - P) x",
    ("discrete", True): "x' (A'PA - rho^2 P) x",
}

# Of the integers in a vector that shows a failure; Python writes 4300 unless told.
MAX_DIGITS = 200_000
# A longer number is shown rounded, except in JSON.
LONGEST = 60


@command("check-lyapunov")
def check_lyapunov(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Modes and P: a .json file.")],
    rate: Annotated[
        str | None,
        typer.Option(help="Decide at this rate: alpha in 1/s, in discrete time rho per step."),
    ] = None,
    discrete: Annotated[
        bool, typer.Option("--discrete", help="The modes are x+ = A x, not x' = A x.")
    ] = False,
) -> Answer:
    """Decide exactly whether x' P x is a common Lyapunov function, whichever program found P.

    The file holds P and the modes as A (one matrix, a list, or A1, A2, ...), and may hold rate and
    time. Exit code 0 if V decreases strictly in every mode, 1 if it does not.

    Example: nrs-design check-lyapunov docs/examples/lyapunov.json
    """
    from nrs_design.api.matrices import check_lyapunov as check
    from nrs_design.arrays.files import read_proposal

    sys.set_int_max_str_digits(MAX_DIGITS)
    proposal = read_proposal(file)
    if discrete and proposal.time == "continuous":
        raise typer.BadParameter(
            f"{file} says that its time is continuous", param_hint="--discrete"
        )
    time = "discrete" if discrete else proposal.time
    wanted = proposal.rate if rate is None else rate
    found = check(proposal.modes, proposal.P, wanted, time=time)
    return Answer(
        lambda: {"file": str(file)} | found.to_dict(),
        lambda: _show(found),
        exit_codes.unless(not found.holds),
    )


def _show(found: LyapunovCheck) -> None:
    from nrs_design.proof.evidence.fields import rate_words

    asked, law = found.asked is not None, _LAW[found.time]
    best = None if found.rate is None else rate_words(found.rate, found.time)
    if found.holds:
        say(
            f"HOLDS: x' P x is positive definite and, along {law}, decreases strictly in every "
            f"mode: {', '.join(mode.name for mode in found.modes)}"
        )
        if best is None:
            say("  The numbers are too large to look for its rate: ask for one with --rate.")
        else:
            say(f"  {'the rate asked for' if asked else 'proved'}: {best}")
        return
    say(
        "DOES NOT HOLD: x' P x is not a common Lyapunov function"
        + (" at this rate." * asked or ".")
    )
    if found.counterexample is not None:
        _show_counterexample(found.counterexample, found.time, asked=asked)
    if best is not None:
        say(f"  Along {law} it decreases strictly in every mode, proved at {best} only.")
    elif found.weak:
        say("  It increases in no mode, which shows stability but no decay.")


def _show_counterexample(failing: Counterexample, time: Time, *, asked: bool) -> None:
    value, *vector = map(_number, (failing.value, *failing.vector))
    if failing.mode is None:
        say(f"  P is not positive definite: x' P x = {value}")
    else:
        too_slowly = " at this rate" * asked
        say(f"  in mode {failing.mode} it does not decrease{too_slowly}:")
        say(f"  {_CHANGE[time, asked]} = {value}, which is not below zero,")
    rounded = any(text.startswith("about") for text in (value, *vector))
    say(f"  at x = ({', '.join(vector)}), {'rounded; --json has it' if rounded else 'exactly'}")


def _number(number: Fraction) -> str:
    from nrs_design.proof.bounds import nearly

    text = str(number)
    return text if len(text) <= LONGEST else nearly(number)
