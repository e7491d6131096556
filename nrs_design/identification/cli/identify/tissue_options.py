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


class ContactOption(StrEnum):
    """Whether air is looked for."""

    AUTO = "auto"
    GIVEN = "given"


class DriftOption(StrEnum):
    """Whether the tare of the force moves."""

    AUTO = "auto"
    FIT = "fit"
    NONE = "none"


Model = Annotated[ModelOption, typer.Option(help="Law to choose; auto compares them all.")]
Start = Annotated[
    float | None, typer.Option("--from", metavar="S", help="First second that is used.")
]
End = Annotated[float | None, typer.Option("--to", metavar="S", help="Last second that is used.")]
Contact = Annotated[
    ContactOption,
    typer.Option(help="Find air and touches, or take the whole record as in contact."),
]
Zero = Annotated[str, typer.Option(metavar="POSITION", help="Position of contact, as in '0.1 m'.")]
Tare = Annotated[str, typer.Option(metavar="FORCE", help="Force in air, as in '-1.3 N' (or N*m).")]
Drift = Annotated[DriftOption, typer.Option(help="Let the tare move with time; auto asks the air.")]
SkipCycles = Annotated[
    int, typer.Option(min=0, metavar="N", help="First loading cycles to set apart.")
]
NegateForce = Annotated[bool, typer.Option("--negate-force", help="Change the sign of the force.")]
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
