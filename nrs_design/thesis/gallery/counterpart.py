"""A printed figure, what was simulated in its place, and how the two compare."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

from nrs_design.reporting.document import Illustration
from nrs_design.simulation.time_response import TimeResponse

# A number that was measured on the robot is reproduced if it is met so well, relative to it. The
# thesis's own six displayed impedances (6.3.1.2) miss the desired one by up to 4.62 %.
MEASURED = 0.05


class Reproducibility(StrEnum):
    """What a statement of the print is worth beside a simulation."""

    REPRODUCED = "reproduced"
    NOT_REPRODUCED = "not reproduced"
    HARDWARE_ONLY = "hardware only"
    OMITTED = "data omitted"
    TAKEN = "taken from the print"


@dataclass(frozen=True, slots=True)
class Statement:
    """One thing that the thesis says of a figure, beside the simulation."""

    quantity: str  # With its unit
    # printed, simulated: numbers, or words.
    printed: str
    simulated: str
    # Taken: an input of the run, which agrees because it was put in. Omitted: what decides it is
    # not in the thesis. Hardware only: no run can show it.
    outcome: Reproducibility
    why: str = ""  # Of all outcomes but *reproduced*, the reason


@dataclass(frozen=True, slots=True)
class Counterpart:
    """What stands for a figure, or for several that show the same."""

    # Numbers of the figures, and what each shows in the print; empty where the thesis draws none.
    shows: Mapping[str, str]
    section: str  # Of the thesis
    title: str  # What was simulated
    statements: tuple[Statement, ...]  # Of the print beside the run
    # given, chosen: inputs of the run: from the thesis, and ours because the thesis omits them.
    given: tuple[str, ...]
    chosen: tuple[str, ...] = ()
    illustrations: tuple[Illustration, ...] = ()  # Drawn
    remark: str = ""  # What else to know; may be empty
    # What is drawn, by the names of their files.
    runs: Mapping[str, TimeResponse] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """What its section is called."""
        numbers = list(self.shows)
        if not numbers:
            return f"Section {self.section}, without a figure"
        if len(numbers) == 1:
            return f"Figure {numbers[0]}"
        joint = "and" if len(numbers) == 2 else "to"
        return f"Figures {numbers[0]} {joint} {numbers[-1]}"


def measured(
    quantity: str, printed: str, value: float, why: str = "", outcome: Reproducibility | None = None
) -> Statement:
    """Return a measured number beside the simulated one.

    Parameters
    ----------
    quantity : str
        With its unit.
    printed : str
        The number as printed.
    value : float
        Simulated.
    why : str
        The reason if it is not reproduced.
    outcome : Reproducibility, optional
        Where it is not for the numbers to say.
    """
    off = value / float(printed) - 1
    near = abs(off) <= MEASURED
    found = outcome or (Reproducibility.REPRODUCED if near else Reproducibility.NOT_REPRODUCED)
    shown = f"{value:.4g} ({_percent(off)})"
    return Statement(
        quantity, printed, shown, found, "" if found is Reproducibility.REPRODUCED else why
    )


def taken(quantity: str, printed: str, value: float) -> Statement:
    """Return a number that was put into the run, and what came of it.

    Parameters
    ----------
    quantity : str
        With its unit.
    printed : str
        As printed.
    value : float
        Simulated.
    """
    return Statement(
        quantity,
        printed,
        f"{value:.4g}",
        Reproducibility.TAKEN,
        "the run is laid out for it: no evidence",
    )


def stated(quantity: str, printed: str, simulated: str, holds: bool, why: str = "") -> Statement:
    """Return a statement in words that a run confirms or contradicts.

    Parameters
    ----------
    quantity, printed, simulated
        As for `Statement`.
    holds : bool
        Whether the run confirms it.
    why : str
        The reason if it does not.
    """
    outcome = Reproducibility.REPRODUCED if holds else Reproducibility.NOT_REPRODUCED
    return Statement(quantity, printed, simulated, outcome, "" if holds else why)


def _percent(off: float) -> str:
    return f"{100 * off:+.2g} %" if abs(off) < 1 else f"{1 + off:.2g} times"
