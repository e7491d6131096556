"""What pages of identifications share: head, data, lights and foot, and estimates in words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from nrs_design import __version__
from nrs_design.identification.finding import is_synthetic
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Bullets, Light, Report, Section, State, Table
from nrs_design.reporting.formatting import number

if TYPE_CHECKING:
    from nrs_design.identification.finding import Finding
    from nrs_design.identification.statistics import Estimate
    from nrs_design.identification.tables.table import Source

IDENTIFIED = "identified"
FOOTER = "Page of nrs-design. An identification is an estimate, not a proof."
FILES = "Data files"
_SYNTHETIC = "SYNTHETIC DATA, made by a simulation and not measured. "
# Records of which figures are drawn.
DRAWN = 6


def facts_of(sources: Iterable[Source]) -> tuple[tuple[str, str], ...]:
    """Return what stands at the head of a page about data."""
    files = list(sources)
    synthetic = sum(source.synthetic for source in files)
    kind = "SYNTHETIC" if synthetic == len(files) else "mixed" if synthetic else "measured"
    return (
        ("Data", f"{kind}, {counted(len(files), 'file')}"),
        ("Package", f"nrs-design {__version__}"),
    )


def identification_page(
    found: Finding,
    name: str,
    title: str,
    claim: str,
    sections: Iterable[Section],
    meaning: Sequence[str] = (),
) -> Report:
    """Return the page about what was found from data; the claim begins with what they are."""
    read = Section("How to read this", (Bullets("", tuple(meaning)),), boxed=True)
    return Report(
        name=name,
        title=title,
        verdict=IDENTIFIED,
        claim=f"{label_of(found.sources)}{claim}",
        remarks=(
            *(f"Remark: {remark}." for remark in found.remarks),
            *(f"Doubt: {caveat}." for caveat in found.caveats),
        ),
        lights=_lights(found),
        facts=facts_of(found.sources),
        sections=(*sections, *([read] if meaning else ()), source_section(found.sources)),
        footer=FOOTER,
    )


def _lights(found: Finding) -> tuple[Light, Light]:
    data = Light("Data", State.GOOD, "measured", FILES)
    if is_synthetic(found.sources):
        data = Light("Data", State.DOUBTFUL, "SYNTHETIC, made by a simulation", FILES)
    if found.caveats:
        return data, Light("Doubts", State.DOUBTFUL, counted(len(found.caveats), "doubt"))
    return data, Light("Doubts", State.GOOD, "none")


def source_section(sources: Iterable[Source]) -> Section:
    """Return the section that names the files."""
    rows = tuple(
        (source.path.name, "SYNTHETIC" if source.synthetic else "measured", source.sha256)
        for source in sources
    )
    return Section(FILES, (Table("Files", ("File", "Data", "SHA-256"), rows),))


def label_of(sources: Sequence[Source]) -> str:
    """Return what must stand before anything that comes of synthetic data."""
    return _SYNTHETIC if is_synthetic(sources) else ""


def marked(name: str, *, chosen: bool) -> str:
    """Return the name of a fit in a table of several."""
    return f"{name} (chosen)" if chosen else name


def in_interval(estimate: Estimate) -> str:
    """Return an estimate with its interval, as wide as it is claimed."""
    wide = estimate.outward()
    return f"{_short(estimate.value)} [{_short(wide.low)}, {_short(wide.high)}]"


def _short(value: float) -> str:
    return number(value, 5) if abs(value) >= 1e-3 or value == 0 else f"{value:.4e}"


def figure_names(names: Sequence[str]) -> list[str]:
    """Return names of figures for names of records, no two alike."""
    plain = [re.sub(r"[^A-Za-z0-9-]+", "-", name) for name in names]
    if len(set(plain)) == len(plain):
        return plain
    return [f"{index}-{name}" for index, name in enumerate(plain, 1)]
