"""Common methods of the results: figures, notebook view, facts."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from html import escape
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from nrs_design.errors import DesignError
from nrs_design.models.axis import axis_context

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.reporting.document import Section
    from nrs_design.search.certification import Certification

# Figure widths of IEEE papers in inches: one column, two columns.
WIDTHS = {"ieee": 3.5, "ieee-two": 7.16}

# Names and functions that draw the figures.
Figures = Iterable[tuple[str, Callable[[], "Figure"]]]


class AbstractResult(ABC):
    """What a verb of the library returns."""

    @abstractmethod
    def _facts(self) -> dict[str, Any]:
        """Return the content of ``--json`` of the command, plain and in SI."""

    def _drawings(self) -> Figures:
        """Yield the figures, that of most use first; by default none."""
        return ()

    @abstractmethod
    def _headline(self) -> str:
        """Return a summary in a line."""

    @abstractmethod
    def _rows(self) -> Iterable[Sequence[str]]:
        """Return the rows of a small table, its heads first."""

    def _axis(self) -> object:
        """Return the axis that sets texts and units; None stands for a rotary axis."""
        return None

    def to_dict(self) -> dict[str, Any]:
        """Return the facts, plain and in SI: what the command of this name prints by ``--json``."""
        with axis_context(self._axis()):
            return self._facts()

    @property
    def figures(self) -> tuple[str, ...]:
        """Names of its figures."""
        with axis_context(self._axis()):
            return tuple(name for name, _ in self._drawings())

    def plot(self, name: str | None = None, width: str | None = None) -> Figure:
        """Return a figure.

        Parameters
        ----------
        name : str, optional
            One of `figures`; by default the first.
        width : {"ieee", "ieee-two"}, optional
            Width of one or two columns of a paper of the IEEE, 3.5 or 7.16 in, with letters of
            8 pt. ``savefig`` writes it as PDF, SVG, PNG or, with XeLaTeX or LuaLaTeX, PGF. Where
            a publisher takes no Type 3 fonts, set ``matplotlib.rcParams["pdf.fonttype"] = 42``.
        """
        from nrs_design.reporting.style import for_paper

        if width is not None and width not in WIDTHS:
            raise DesignError(f"there is no width {width!r}", remedy=f"{' or '.join(WIDTHS)}")
        with axis_context(self._axis()), for_paper(None if width is None else WIDTHS[width]):
            names = []
            for known, draw in self._drawings():
                if name in (None, known):
                    return draw()
                names.append(known)
        if not names:
            raise DesignError("there is nothing to draw", remedy=self._headline())
        raise DesignError(
            f"there is no figure {name!r}", remedy=f"figures here: {', '.join(names)}"
        )

    def _table(self) -> list[Sequence[str]]:
        with axis_context(self._axis()):
            return list(self._rows())

    def __repr__(self) -> str:
        """Return type and summary in a line."""
        return f"<{type(self).__name__} {self._headline()}>"

    def __str__(self) -> str:
        """Return the summary and the rows."""
        heads, *rows = self._table()
        lines = [f"{row[0]}: {', '.join(_label_cells(heads, row))}" for row in rows]
        return "\n".join([self._headline(), *(f"  {line}" for line in lines)])

    def _repr_html_(self) -> str:
        """Show it in a notebook."""
        heads, *rows = ([escape(cell) for cell in row] for row in self._table())
        head = "".join(f"<th>{cell}</th>" for cell in heads)
        body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
        first = f"<tr>{head}</tr>" if any(heads) else ""
        table = f"<table>{first}{body}</table>" if rows else ""
        return f"<p><strong>{escape(self._headline())}</strong></p>{table}"


def section_figures(sections: Iterable[Section], first: str = "") -> Figures:
    """Return the figures of sections, which are drawn already, the one of a name first."""
    found = [item for section in sections for item in section.illustrations]
    found.sort(key=lambda item: item.name != first)
    return [(item.name, partial(attrgetter("figure"), item)) for item in found]


def evidence_drawings(certification: Certification) -> Figures:
    """Return the figures of the evidence; a run with its bound comes first."""
    from nrs_design.reporting.evidence import evidence_sections

    return section_figures(evidence_sections(certification), "run")


def _label_cells(heads: Sequence[str], row: Sequence[str]) -> list[str]:
    """Return the other cells of a row that say something, each after its head."""
    cells = zip(heads[1:], row[1:], strict=True)
    return [f"{head} {cell}".strip() for head, cell in cells if cell]
