"""Options of ``nrs-design simulate``: of each run, and of many instead of those of the spec."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from nrs_design.cli.seconds import seconds
from nrs_design.spec.scenarios import LARGEST_SEED

PANEL = "Many runs"


class EngineOption(StrEnum):
    """What simulates."""

    EXACT = "exact"
    SAMPLED = "sampled"
    MUJOCO = "mujoco"


Scenarios = Annotated[
    list[str] | None,
    typer.Option("--scenario", metavar="NAME", help="One scenario, or several; default: all."),
]
Engine = Annotated[
    EngineOption | None,
    typer.Option(
        help="exact: continuous time, from event to event; sampled: the law that ships, in "
        "single precision; mujoco: the same law on MuJoCo's mechanics (extra mujoco), and how "
        "far that is from the sampled engine. Default: sampled where the spec has sampling, "
        "tissue is not linear, or three axes move."
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER",
        help="Write SPEC.SCENARIO.svg, .png, .csv and .npz of every run there.",
    ),
]
BoundsOf = Annotated[
    Path | None,
    typer.Option(metavar="CERT", help="Show the bounds of this certificate of the spec."),
]
Bound = Annotated[
    bool,
    typer.Option(help="Certify a bound where the spec says what disturbs the loop."),
]
Period = Annotated[
    float | None,
    typer.Option(
        metavar="S",
        parser=seconds(1e-5, 1.0),
        help="Period of the sampled engine in s, not the spec's; without either, 0.002.",
    ),
]
Delay = Annotated[
    int | None,
    typer.Option(min=0, max=10, help="Age of its force samples in samples, not the spec's."),
]
OuterPeriod = Annotated[
    float | None,
    typer.Option(
        metavar="S",
        min=1e-5,
        max=1.0,
        help="Period of its force samples and admittances in s, not that of the motion loop.",
    ),
]
MaxSteps = Annotated[
    int | None, typer.Option(min=1, help="Most steps of a run; beyond, exit code 3.")
]
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
    """What is asked for beside, or in the place of, the scenarios as they are written."""

    worst: bool  # Whether an adversary is to search
    runs: int | None  # How many runs are drawn
    # seed, jobs: of these.
    seed: int
    jobs: int
    resume: Path | None  # Keeps what is drawn

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
