"""Options of ``nrs-design simulate``."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from nrs_design.cli.seconds import seconds


class EngineOption(StrEnum):
    """What simulates."""

    EXACT = "exact"
    SAMPLED = "sampled"


Scenarios = Annotated[
    list[str] | None,
    typer.Option("--scenario", metavar="NAME", help="One scenario, or several; default: all."),
]
Engine = Annotated[
    EngineOption | None,
    typer.Option(
        help="exact: continuous time, from event to event; sampled: the law that ships, in "
        "single precision. Default: sampled where the spec has sampling or tissue is not linear."
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER",
        help="Write SPEC.SCENARIO.svg, .png and .csv of every run there.",
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
        help="Let an adversary choose controllers, contact, delay and disturbances, and show the "
        "worst runs that he finds.",
    ),
]
