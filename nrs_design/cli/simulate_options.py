"""Options of ``nrs-design simulate`` that ask for many runs, not for those of the spec."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from nrs_design.spec.scenarios import LARGEST_SEED

PANEL = "Many runs"

WorstCaseFlag = Annotated[
    bool,
    typer.Option(
        "--worst-case",
        rich_help_panel=PANEL,
        help="Let an adversary choose controllers, contact, delay and disturbances, and show the "
        "worst runs that he finds.",
    ),
]
MonteCarloRuns = Annotated[
    int | None,
    typer.Option(
        "--monte-carlo",
        metavar="N",
        min=1,
        max=1_000_000,
        rich_help_panel=PANEL,
        help="Simulate the scenarios N times, with parameters drawn from their ranges.",
    ),
]
Jobs = Annotated[
    int,
    typer.Option(
        min=1, max=256, rich_help_panel=PANEL, help="Processes that simulate; the result is the "
        "same.",
    ),
]  # fmt: skip
Seed = Annotated[
    int,
    typer.Option(
        min=0,
        max=LARGEST_SEED,
        rich_help_panel=PANEL,
        help="Of --worst-case and --monte-carlo.",
    ),
]
Resume = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        rich_help_panel=PANEL,
        help="Keep the result of every run of --monte-carlo there, and go on from there where it "
        "was interrupted.",
    ),
]


@dataclass(frozen=True, slots=True)
class Many:
    """What is asked for beside, or in the place of, the scenarios as they are written.

    Parameters
    ----------
    worst : bool
        Whether an adversary is to search.
    runs : int or None
        How many runs are drawn.
    seed, jobs : int
        Of these.
    resume : Path or None
        Keeps what is drawn.
    """

    worst: bool
    runs: int | None
    seed: int
    jobs: int
    resume: Path | None

    def check(self, of_scenarios: tuple[object, ...]) -> None:
        """Refuse options that exclude each other, or that nothing would heed.

        Raises
        ------
        typer.BadParameter
            If there are such.
        """
        if self.worst and self.runs is not None:
            raise typer.BadParameter(
                "one excludes the other", param_hint="--worst-case, --monte-carlo"
            )
        if self.worst and any(given is not None and given != [] for given in of_scenarios):
            message = "the adversary plays against the loop of the spec, not within a scenario"
            raise typer.BadParameter(message, param_hint="--worst-case")
        if self.runs is None and (self.resume is not None or self.jobs != 1):
            raise typer.BadParameter("needs --monte-carlo", param_hint="--resume, --jobs")
        if self.runs is None and not self.worst and self.seed:
            message = "needs --monte-carlo or --worst-case; a scenario has its own seed"
            raise typer.BadParameter(message, param_hint="--seed")
