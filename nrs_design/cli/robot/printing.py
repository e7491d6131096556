"""Numbers, vectors and matrices as one table."""

from __future__ import annotations

from typing import Any

from nrs_design.cli.tables import print_table

_UNPRINTED = ("units", "files")


def print_quantities(content: dict[str, Any]) -> None:
    """Print named numbers, rows of three and matrices, all in SI units."""
    rows: list[list[str]] = []
    for name, value in content.items():
        if name not in _UNPRINTED:
            rows += _rows(name.replace("_", " "), value)
    print_table("", ["SI units", "1", "2", "3"], rows)


def _rows(name: str, value: Any) -> list[list[str]]:
    if isinstance(value, dict):
        return [row for key, inner in value.items() for row in _rows(f"{name}: {key}", inner)]
    if isinstance(value, list) and isinstance(value[0], list):
        return [_row(name if index == 0 else "", line) for index, line in enumerate(value)]
    return [_row(name, value if isinstance(value, list) else [value])]


def _row(name: str, numbers: list[float]) -> list[str]:
    cells = [f"{number:.8g}" for number in numbers]
    return [name, *cells, *[""] * (3 - len(cells))]
