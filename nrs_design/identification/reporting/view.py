"""Output of an identification: facts for JSON, lines for a terminal, sections of a page."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nrs_design import __version__
from nrs_design.identification.numeric import Array, Flags
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Block, Bullets, Illustration, Report, Section, Table
from nrs_design.reporting.style import BLUE, INK, VERMILLION, legend, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.identification.datasets.records import AbstractIdentification
    from nrs_design.identification.statistics import Estimate
    from nrs_design.identification.tables.table import Source


def is_synthetic(sources: Sequence[Source]) -> bool:
    """Tell whether a simulation made some of the data."""
    return any(source.synthetic for source in sources)


# Of JSON.
Facts = dict[str, Any]

SYNTHETIC = "SYNTHETIC data: made by a simulation, not measured."
# Records of which figures are drawn.
MAX_FIGURES = 6
_FOOTER = "Page of nrs-design. An identification is an estimate, not a proof."
# Most points of a curve on a page.
_POINTS = 1500
_MEASURED = "#7d8894"
_UNUSED = "#d9b7a0"


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """A measured and a fitted output over time."""

    title: str  # Name of the record
    note: str  # Caption of the fit
    label: str  # Quantity and unit of the output
    # time, measured, fitted: shape (n,), time in s.
    time: Array
    measured: Array
    fitted: Array
    fit_mask: Flags | None = None  # Samples that were fitted; None for all


@dataclass(frozen=True, slots=True, eq=False)
class FindingView:
    """A finding in words and numbers."""

    result: AbstractIdentification[Any]
    kind: str  # ``tissue``, ``actuator`` or ``delay``
    method: str  # Law, method or model
    reason: str  # Reason of the choice, or the columns
    ranges: Mapping[str, tuple[Estimate, str]]  # The numbers and their units, by name
    facts: Facts  # Facts of this kind of identification
    lines: Sequence[str]  # For a terminal, and for the page
    title: str  # Title of the page
    claim: str  # First sentences of the page
    curves: Callable[[], Iterable[Curve]]
    details: Sequence[str] = ()  # Further lines, of a terminal with ``-v``
    fits: Table | None = None  # All fits, where there are several
    blocks: Sequence[Block] = ()  # Further blocks of the page

    @property
    def document(self) -> Facts:
        """The facts for JSON."""
        result = self.result
        return {
            "synthetic": is_synthetic(result.sources),
            "records": source_facts(result.sources),
            **self.facts,
            "remarks": list(result.remarks),
            "doubts": list(result.doubts),
            "caveats": list(result.caveats),
        }

    def page(self) -> Report:
        """Return the page; the claim begins with what the data are."""
        result, sources = self.result, self.result.sources
        synthetic = sum(source.synthetic for source in sources)
        kind = "SYNTHETIC" if synthetic == len(sources) else "mixed" if synthetic else "measured"
        # Claims and captions of synthetic data begin with this warning.
        warning = "SYNTHETIC DATA, made by a simulation and not measured. "
        label = warning if synthetic else ""
        files = tuple(
            (source.path.name, "SYNTHETIC" if source.synthetic else "measured", source.sha256)
            for source in sources
        )
        figures = tuple(
            Illustration(f"fit-{i}", curve.title, f"{label}{curve.note}", _draw(curve))
            for i, curve in zip(range(1, MAX_FIGURES + 1), self.curves(), strict=False)
        )
        fits = () if self.fits is None else (self.fits,)
        return Report(
            name=f"{self.kind}-{self.method}" if self.kind == "tissue" else self.kind,
            title=self.title,
            verdict="identified",
            claim=f"{label}{self.claim}",
            remarks=(
                *(f"Remark: {remark}." for remark in result.remarks),
                *(f"Doubt: {caveat}." for caveat in result.caveats),
            ),
            facts=(
                ("Data", f"{kind}, {counted(len(sources), 'file')}"),
                ("Package", f"nrs-design {__version__}"),
            ),
            sections=(
                Section("What was found", (Bullets("", (*self.lines, *self.details)),)),
                Section("Fits", (*fits, *self.blocks)),
                Section("Measured against fitted", figures),
                Section("Data files", (Table("Files", ("File", "Data", "SHA-256"), files),)),
            ),
            footer=_FOOTER,
        )


def source_facts(files: Iterable[Source]) -> list[Facts]:
    """Return what identifies the data files, for JSON."""
    return [
        {"file": str(file.path), "sha256": file.sha256, "synthetic": file.synthetic}
        for file in files
    ]


def estimate_numbers(estimate: Estimate) -> dict[str, float | None]:
    """Return an estimate for JSON, which has no infinity; None says unlimited."""
    low, high = (end if math.isfinite(end) else None for end in (estimate.low, estimate.high))
    return {"value": estimate.value, "low": low, "high": high}


def marked(name: str, *, is_chosen: bool) -> str:
    """Return the name of a fit in a table of several."""
    return f"{name} (chosen)" if is_chosen else name


@styled
def _draw(curve: Curve) -> Figure:
    """Draw both outputs over time, and their difference below; unused samples are pale."""
    pick, fit_mask = slice(None, None, max(1, -(-len(curve.time) // _POINTS))), curve.fit_mask
    points = np.ones(len(curve.time), bool)[pick] if fit_mask is None else fit_mask[pick]
    figure = new_figure(4.4)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1.0])
    t, data, fitted = (a[pick] for a in (curve.time, curve.measured, curve.fitted))
    upper.plot(t[points], data[points], ".", color=_MEASURED, markersize=4.0, label="data")
    if not points.all():
        upper.plot(t[~points], data[~points], "x", color=_UNUSED, markersize=3.5, label="not used")
    upper.plot(t, np.where(points, fitted, np.nan), color=BLUE, label="fitted", linewidth=1.4)
    upper.set_ylabel(curve.label)
    lower.plot(t[points], (data - fitted)[points], ".", color=VERMILLION, markersize=2.5)
    lower.axhline(0.0, color=INK, linewidth=0.8)
    # Short enough for its height.
    lower.set_ylabel("Data - fitted")
    lower.set_xlabel("Time [s]")
    legend(figure, upper)
    return figure
