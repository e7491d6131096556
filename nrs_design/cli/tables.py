"""Tables on stdout: transposed, not folded, where they would be too wide."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from nrs_design.cli.printing import columns as columns_of
from nrs_design.cli.printing import say
from nrs_design.printable import printable

if TYPE_CHECKING:
    from nrs_design.reporting.document import Block

Cells = Sequence[str]

# Longer cells are sentences and may be wrapped; shorter ones are never broken.
SENTENCE = 40
# Spaces between two columns; both edges together have one less.
_GAP = 3


def print_blocks(name: str, blocks: Iterable[Block]) -> None:
    """Print tables, with a name before their titles, and sentences."""
    from nrs_design.reporting.document import Paragraph, Table

    for block in blocks:
        if isinstance(block, Table):
            print_table(f"{name}: {block.title}", block.columns, block.rows)
        elif isinstance(block, Paragraph):
            say(block.text)


def print_table(title: str, columns: Cells, source_rows: Iterable[Cells]) -> None:
    """Print a plain table; a second line of a heading is its unit.

    Where it is wider than a line may be, rows become columns, side by side as far as they fit; a
    number is never broken.
    """
    rows = [["\n".join(map(printable, cell.split("\n"))) for cell in row] for row in source_rows]
    width = columns_of(sys.stdout)
    if _least_width([columns, *rows]) <= width:
        _print(title, columns, rows, width)
        return
    for index, (head, *body) in enumerate(_transposed_tables(columns, rows, width)):
        _print("" if index else title, head, body, width)


def _transposed_tables(columns: Cells, rows: Sequence[Cells], width: int) -> Iterator[list[Cells]]:
    """Yield transposed tables: the headings, then all rows that fit into the width."""
    headings = [" ".join(column.split("\n")) for column in columns]
    group: list[Cells] = []
    for row in rows:
        if group and _least_width(_transpose([headings, *group, row])) > width:
            yield _transpose([headings, *group])
            group = []
        group.append(row)
    yield _transpose([headings, *group])


def _transpose(rows: Sequence[Cells]) -> list[Cells]:
    return [list(cells) for cells in zip(*rows, strict=True)]


def _least_width(rows: Sequence[Cells]) -> int:
    return sum(_least_widths(rows)) + _GAP * len(rows[0]) - 1


def _least_widths(rows: Sequence[Cells]) -> list[int]:
    return [max(map(_least_cell_width, cells)) for cells in zip(*rows, strict=True)]


def _least_cell_width(cell: str) -> int:
    from rich.cells import cell_len

    widest = max(map(cell_len, cell.split("\n")))
    if widest <= SENTENCE:
        return widest
    return max(SENTENCE // 2, *map(cell_len, cell.split()))


def _print(title: str, columns: Cells, rows: Sequence[Cells], width: int) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    table = Table(title_justify="left", box=SIMPLE_HEAD, pad_edge=False)
    table.title = printable(title) or None
    narrowest_widths = _least_widths([columns, *rows])
    fits = _least_width([columns, *rows]) <= width
    for column, narrowest in zip(columns, narrowest_widths, strict=True):
        table.add_column(column, overflow="fold", min_width=narrowest if fits else None)
    for row in rows:
        table.add_row(*row)
    Console(width=width, markup=False, emoji=False, highlight=False).print(table)
