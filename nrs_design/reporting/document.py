"""The report as a document: sections of text, tables and figures, in no file format yet.

Every number is already text. The HTML and the PDF are two renderings of the same document.
"""

from __future__ import annotations

import datetime
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Running text."""

    text: str


@dataclass(frozen=True, slots=True)
class Bullets:
    """A list of statements under a heading of its own (empty for none)."""

    title: str
    items: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """A table of formatted cells; the first column names the row.

    Parameters
    ----------
    title : str
        Caption above the table.
    columns : tuple of str
        Headings, with units.
    rows : tuple of tuple of str
        Cells.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class Illustration:
    """A figure with what it shows.

    Parameters
    ----------
    name : str
        Unique in the report; letters, digits and hyphens, so that it can be a file name.
    title : str
        Heading above the figure.
    caption : str
        What is seen, and what it does not show.
    figure : matplotlib.figure.Figure
        Drawn, but not yet in a file format.
    """

    name: str
    title: str
    caption: str
    figure: Figure


Block = Paragraph | Bullets | Table | Illustration


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the report; a boxed one stands out from the others."""

    title: str
    blocks: tuple[Block, ...]
    boxed: bool = False


@dataclass(frozen=True, slots=True)
class Report:
    """The whole report.

    Parameters
    ----------
    name, title : str
        Of the spec; the title may be empty.
    verdict : {"proved", "refuted", "inconclusive", "identified", "inside", "outside", "same", \
"different"}
        Of the certification, the judgement of a run or a comparison, or that this is an
        identification.
    claim : str
        What the certificate states about stability, or that nothing is known.
    remarks : tuple of str
        What else is shown, such as that no common quadratic function exists.
    facts : tuple of (str, str)
        Label and value: hashes, versions, rates.
    sections : tuple of Section
        In reading order.
    footer : str
        Last line of the page.
    date : datetime.date, optional
        As the reader gave it. Without one the report has no date, and the same spec gives the
        same report on any day.
    """

    name: str
    title: str
    verdict: str
    claim: str
    remarks: tuple[str, ...]
    facts: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...]
    footer: str = (
        "Report of nrs-design. Figures are floating-point illustrations; the certificate is the "
        "proof."
    )
    date: datetime.date | None = None

    @property
    def illustrations(self) -> Iterator[Illustration]:
        """All figures in reading order."""
        for section in self.sections:
            for block in section.blocks:
                if isinstance(block, Illustration):
                    yield block
