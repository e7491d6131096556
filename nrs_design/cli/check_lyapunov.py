"""``nrs-design check-lyapunov``: the exact verdict on anybody's P."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import say

# Of the integers in a vector that shows a failure; Python writes 4300 unless told.
MAX_DIGITS = 200_000


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
    from nrs_design.api.proposal import read_proposal

    sys.set_int_max_str_digits(MAX_DIGITS)
    proposal = read_proposal(file)
    if discrete and proposal.time == "continuous":
        raise typer.BadParameter(
            f"{file} says that its time is continuous", param_hint="--discrete"
        )
    time = "discrete" if discrete else proposal.time
    wanted = proposal.rate if rate is None else rate
    found = check(proposal.modes, proposal.P, wanted, time=time)

    def show() -> None:
        for line in found.lines():
            say(line)

    code = exit_codes.unless(not found.holds)
    return Answer(lambda: {"file": str(file)} | found.to_dict(), show, code)
