"""The report as a document: sections of text, tables and figures, in no file format yet.

Every number is already text.
"""

from __future__ import annotations

import datetime
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Linked(str):
    """Text with a link: to a line of the spec, counted from 1, or to a section by its title."""

    __slots__ = ("line", "section")
    line: int
    section: str

    def __new__(cls, text: str, line: int = 0, section: str = "") -> Self:
        """Attach a line or a section to a text."""
        linked_text = super().__new__(cls, text)
        linked_text.line, linked_text.section = line, section
        return linked_text


class State(StrEnum):
    """State of a light; its text says the same."""

    GOOD = "good"
    DOUBTFUL = "doubtful"
    BAD = "bad"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Light:
    """Status of one topic at the top of the page."""

    name: str  # Topic, such as ``Proof``
    state: State  # Colour and sign
    text: str  # Status in a phrase
    section: str = ""  # Title of the section that says more; empty for none


@dataclass(frozen=True, slots=True)
class Listing:
    """Numbered lines of a file, which cells link to."""

    title: str
    lines: tuple[str, ...]


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
    """A table of formatted cells; the first column names the row."""

    title: str  # Caption above the table
    columns: tuple[str, ...]  # Headings, with units
    # Cells; a `Linked` cell leads to its line of the spec.
    rows: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class Illustration:
    """A figure with what it shows."""

    name: str  # Unique in the report; letters, digits and hyphens, so that it can be a file name
    title: str  # Heading above the figure
    caption: str  # Content of the figure, and its limits
    figure: Figure  # Drawn, but not yet in a file format


Block = Paragraph | Bullets | Table | Illustration | Listing


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the report; a boxed one stands out from the others."""

    title: str
    blocks: tuple[Block, ...]
    boxed: bool = False
    folded: bool = False  # Only the title is shown until a reader opens the section

    @property
    def illustrations(self) -> list[Illustration]:
        """Its figures in reading order."""
        return [block for block in self.blocks if isinstance(block, Illustration)]


@dataclass(frozen=True, slots=True)
class Report:
    """The whole report."""

    # name, title: of the spec; the title may be empty.
    name: str
    title: str
    verdict: str  # Verdict of the certification, of a run or of a robot, or ``identification``
    claim: str  # Claim of the certificate about stability, or ``NO_CLAIM``
    # Other claims, such as that no common quadratic function exists.
    remarks: tuple[str, ...]
    # Label and value: hashes, versions, rates; values may have links.
    facts: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...]  # In reading order
    # Last line of the page.
    footer: str = (
        "Report of nrs-design. Figures are floating-point illustrations; the certificate is the "
        "proof."
    )
    # Two sentences at the top: the conclusion and its assumptions. The claim follows them.
    summary: tuple[str, ...] = ()
    lights: tuple[Light, ...] = ()  # Below the sentences
    key: tuple[tuple[str, str], ...] = ()  # Label and value of what a reader wants to know first
    lead: str = ""  # Name of the figure next to the key facts, or empty
    # The text of the certificate that its id is the hash of, which a page can check; or empty.
    certificate: str = ""
    # Date of the reader. Without a date, the same spec gives the same report on any day.
    date: datetime.date | None = None

    @property
    def line_count(self) -> int:
        """Number of lines of the spec in the report; other lines have no links."""
        blocks = (block for section in self.sections for block in section.blocks)
        return max((len(block.lines) for block in blocks if isinstance(block, Listing)), default=0)

    @property
    def anchors(self) -> dict[str, str]:
        """Name of the first section of each title, for links within the page."""
        return {s.title: f"section-{n}" for n, s in reversed([*enumerate(self.sections, 1)])}

    @property
    def illustrations(self) -> Iterator[Illustration]:
        """All figures in reading order."""
        for section in self.sections:
            yield from section.illustrations
