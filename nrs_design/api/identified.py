"""Identified tissue, actuator or delay, as a result of the library."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from nrs_design.api.result import AbstractResult, Figures, section_figures
from nrs_design.proof.bounds import lower, upper
from nrs_design.wings import load_wing

if TYPE_CHECKING:
    from nrs_design.reporting import Report


# A CSV file, or columns by name.
Records = str | Path | Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class FittedRange:
    """A number with its interval."""

    value: float  # The estimate
    # low, high: ends of the interval; 0 and infinity where the records say nothing.
    low: float
    high: float
    unit: str = ""

    def __str__(self) -> str:
        """Value and interval, its ends rounded outwards."""
        high = "inf" if self.high == float("inf") else upper(Fraction(self.high), 5)
        low = lower(Fraction(self.low), 5)
        return f"{self.value:.5g} [{low}, {high}] {self.unit}".rstrip()


@dataclass(frozen=True, repr=False)
class Identification(AbstractResult):
    """What records say: an estimate, not a proof."""

    kind: str  # Kind of the records
    chosen: str  # Which law or method was chosen
    reason: str  # Reason of the choice, or its subject
    ranges: Mapping[str, FittedRange]  # The numbers, at 95 %: `facts` says of what covers more
    files: tuple[Path, ...]  # The records
    synthetic: bool  # Some records come from a simulation
    remarks: tuple[str, ...]  # Assumptions of the numbers
    doubts: tuple[str, ...]  # Reasons against the numbers
    caveats: tuple[str, ...]  # Conditions for a proof that uses the numbers
    facts: Mapping[str, Any]  # Content of ``--json``
    page: Callable[[], Report]  # Draws its page

    def _facts(self) -> dict[str, Any]:
        return dict(self.facts)

    def _drawings(self) -> Figures:
        return section_figures(self.page().sections)

    def _headline(self) -> str:
        data_note = "SYNTHETIC data, " if self.synthetic else ""
        count = len(self.doubts)
        doubts = f"{count} doubt{'s' * (count != 1)}" if count else "no doubts"
        return f"{self.kind}: {self.chosen}, {data_note}{doubts}"

    def _rows(self) -> Iterator[Sequence[str]]:
        yield "", "value [95 % interval]"
        for name, found in self.ranges.items():
            yield name, str(found)
        for doubt in self.doubts:
            yield "doubt", doubt


def identify(
    records: Records | Iterable[Records],
    kind: str = "tissue",
    *,
    law: str | None = None,
    columns: Mapping[str, str] | None = None,
) -> Identification:
    """Find a tissue, an actuator or a delay in records, with 95 % intervals.

    Parameters
    ----------
    records : path-like, mapping of str to array, DataFrame, or iterable of these
        CSV files, or columns by name; see `nrs-design identify` for the names. Of a delay, one.
    kind : {"tissue", "actuator", "delay"}
        Kind of the records. Resistance and torque of an actuator are said for the motor of
        thesis table 4.1; gain, time constant, friction and dead time depend on no data sheet.
    law : str, optional
        Of the tissue; by default the one that the records speak for.
    columns : mapping of str to str, optional
        Foreign names of columns, as in ``{"force_N": "Fz"}``; of a delay, which columns are its
        ``command`` and what was ``measured``.

    Examples
    --------
    >>> import nrs_design as nrs
    >>> found = nrs.identify([f"specs/data/silicone-soft-{i}.csv" for i in (1, 2, 3)])
    >>> found.chosen, list(found.ranges), found.ranges["k"].unit, found.doubts
    ('elastic', ['k'], 'N/m', ())
    """
    # A DataFrame has columns by name, as a mapping does.
    one = isinstance(records, str | Path) or hasattr(records, "keys")
    files = [records] if one else [*cast("Iterable[Records]", records)]
    library = load_wing("identification", "api.library")
    found: Identification = library.identify_records(files, kind, law, columns or {})
    return found
