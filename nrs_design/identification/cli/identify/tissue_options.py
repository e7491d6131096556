"""Options of ``nrs-design identify tissue``: which samples are used, and what is fitted."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer

from nrs_design.identification.cli.identify.common import CoversOption
from nrs_design.models.contact import LAWS


class ModelOption(StrEnum):
    """Laws by name, from their table."""

    _ignore_ = "law"
    AUTO = "auto"
    for law in LAWS:
        vars()[law.replace("-", "_").upper()] = law


Model = Annotated[ModelOption, typer.Option(help="Law to choose; auto compares them all.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help="What is used of a record: start, end (s), contact (auto, given), zero, tare (fit, or "
        "such as '0.1 m', '-1.3 N'), drift (auto, fit, none), skip_cycles, negate (true).",
    ),
]
Covers = Annotated[
    CoversOption,
    typer.Option(help="What the range holds: the mean, 95 % of specimens, or the next one."),
]
Preload = Annotated[
    str | None,
    typer.Option(metavar="LOW..HIGH", help="Deflections of a power law, as in '1 mm..3 mm'."),
]
Prony = Annotated[
    bool, typer.Option("--prony", help="Fit a Prony series, too: is one relaxation enough?")
]
LeverArm = Annotated[
    str | None,
    typer.Option(metavar="LENGTH", help="Distance from pivot to contact, as in '0.24 m'."),
]
EnvironmentName = Annotated[
    str | None, typer.Option(metavar="NAME", help="Environment of the spec to write to.")
]
