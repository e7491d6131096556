"""Numbers, vectors and matrices as tables with named columns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from nrs_design.cli.tables import print_table

# What the numbers of a row belong to.
POSE = ("phi", "psi", "d")
JOINTS = ("theta1", "theta2", "theta3")
LEGS = ("left leg", "right leg", "middle leg")
ONE = ("value",)

# What stands in a row: a name with its unit, and for a matrix what each of its rows belongs to.
RowLabel = str | tuple[str, Sequence[str]]
# For the headings of some columns, the names whose numbers stand below them.
Tables = Mapping[Sequence[str], Mapping[str, RowLabel]]


def print_quantities(content: Mapping[str, Any], tables: Tables) -> None:
    """Print numbers, rows of three and matrices of the content, all in SI units."""
    for columns, labels in tables.items():
        rows = [
            [title, *(f"{number:.8g}" for number in numbers)]
            for name, label in labels.items()
            if name in content
            for title, numbers in _rows(label, content[name])
        ]
        if rows:
            print_table("", ["SI units", *columns], rows)


def _rows(label: RowLabel, value: Any) -> Iterator[tuple[str, Sequence[float]]]:
    if isinstance(label, tuple):
        yield from ((f"{label[0]}: {name}", row) for name, row in zip(label[1], value, strict=True))
    elif isinstance(value, dict):
        for key, inner in value.items():
            yield from _rows(f"{label}: {key}", inner)
    else:
        yield label, value if isinstance(value, list) else [value]


def lists(found: object, *names: str) -> dict[str, Any]:
    """Return the arrays of a result by name, as JSON has them."""
    return {name: getattr(found, name).tolist() for name in names}
