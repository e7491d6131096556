"""The floors of the package and what they import of each other, drawn from the code.

Rows import columns. The order is that of the table in docs/architecture.md, ground floor last; what
stands on the far side of the diagonal would be an import upwards.
"""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Iterator
from html import escape
from pathlib import Path

CELL, LEFT, TOP = 26, 190, 190


# The folders and modules that stand on a floor.
Floor = tuple[str, ...]


def floors_of(text: str) -> list[Floor]:
    """Return the floors that a page lists in its table, the top one first."""
    rows = re.findall(r"^\| ((?:`\w+`,? ?)+) \|", text, re.MULTILINE)
    return [tuple(re.findall(r"`(\w+)`", row)) for row in rows]


def imports_between(package: Path, floors: list[Floor]) -> Counter[tuple[Floor, Floor]]:
    """Count the modules of one floor that import another floor."""
    on = {name: floor for floor in floors for name in floor}
    return Counter(
        (on[source], target)
        for path in sorted(package.rglob("*.py"))
        if (source := path.relative_to(package).with_suffix("").parts[0]) in on
        for target in {on[name] for name in _targets(path, package.name) if name in on}
        if target != on[source]
    )


def label(floor: Floor) -> str:
    """Name a floor by its first folders."""
    return ", ".join(floor[:2]) + (", ..." if len(floor) > 2 else "")


def _targets(path: Path, package: str) -> Iterator[str]:
    """Yield the folders that a file imports from."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == package:
            inner = (node.module or "").split(".")[1:]
            yield from inner[:1] or [alias.name for alias in node.names]


def drawing(package: Path, text: str) -> str:
    """Return the matrix of imports as an SVG that takes its colour from the page."""
    floors = floors_of(text)
    counted = imports_between(package, floors)
    upward = sum(floors.index(target) < floors.index(source) for source, target in counted)
    width, height = LEFT + CELL * len(floors) + 8, TOP + CELL * len(floors) + 8
    said = (
        f"{len(floors)} floors; {sum(counted.values())} imports of modules from other floors, "
        f"{upward or 'none'} of them upward"
    )
    return "\n".join(
        [
            f'<figure><svg viewBox="0 0 {width} {height}" role="img" class="floors" '
            f'aria-label="Imports between floors: {said}" xmlns="http://www.w3.org/2000/svg">',
            *_labels(floors),
            *_marks(floors, counted),
            "</svg>",
            f"<figcaption>Rows import columns; a disc is larger where more modules do. {said}."
            "</figcaption></figure>",
        ]
    )


def _labels(floors: list[Floor]) -> Iterator[str]:
    for place, floor in enumerate(floors):
        name, middle = label(floor), CELL * place + CELL / 2
        yield (
            f'<text x="{LEFT - 6}" y="{TOP + middle + 4}" text-anchor="end">{escape(name)}</text>'
            f'<text transform="translate({LEFT + middle + 4} {TOP - 6}) rotate(-90)">'
            f"{escape(name)}</text>"
        )
        start, corner = TOP + CELL * place, LEFT + CELL * place
        yield (
            f'<path class="grid" d="M{LEFT} {start}h{CELL * len(floors)}'
            f'M{corner} {TOP}v{CELL * len(floors)}"/>'
            f'<rect class="self" x="{corner}" y="{start}" width="{CELL}" height="{CELL}"/>'
        )


def _marks(floors: list[Floor], counted: Counter[tuple[Floor, Floor]]) -> Iterator[str]:
    for (source, target), count in sorted(counted.items()):
        x = LEFT + CELL * floors.index(target) + CELL / 2
        y = TOP + CELL * floors.index(source) + CELL / 2
        radius = min(2.5 + 1.3 * count**0.5, CELL / 2 - 1)
        yield (
            f'<circle cx="{x}" cy="{y}" r="{radius:.1f}">'
            f"<title>{label(source)} import {label(target)}: {count}</title></circle>"
        )
