"""Options that set how the gradient iteration runs."""

from __future__ import annotations

from typing import Annotated

import typer

PANEL = "Gradient iteration"

Relaxation = Annotated[
    float,
    typer.Option(min=0.0, max=2.0, rich_help_panel=PANEL, help="The alpha of thesis 5.25."),
]
Radius = Annotated[
    float, typer.Option(rich_help_panel=PANEL, help="The r of thesis 5.25, above 0.")
]
StartMode = Annotated[
    str | None,
    typer.Option(
        metavar="MODE", rich_help_panel=PANEL, help="Gives the first Q; default the first mode."
    ),
]
Seed = Annotated[int, typer.Option(min=0, rich_help_panel=PANEL, help="Of the random order.")]
MaxUpdates = Annotated[
    int, typer.Option(min=0, rich_help_panel=PANEL, help="Updates after which it gives up.")
]
