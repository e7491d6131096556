"""The files of runs: of each its table, and its figure twice."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.cli.printing import note
from nrs_design.output import PNG, SVG, Beginning, Output, check_place, write_outputs

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _places(folder: Path, name: str, table: Beginning) -> dict[Path, Beginning]:
    """Return ``NAME.csv``, ``.svg`` and ``.png``, and how one that may be replaced begins."""
    kinds: dict[str, Beginning] = {"csv": table, "svg": SVG, "png": PNG}
    return {folder / f"{name}.{ending}": kind for ending, kind in kinds.items()}


def check_runs(folder: Path | None, names: Iterable[str], table: Beginning) -> None:
    """Refuse, before the work, a folder in which something else stands at one of the places."""
    if folder is None:
        return
    for name in names:
        for place, kind in _places(folder, name, table).items():
            check_place(place, kind)


def write_runs(
    folder: Path | None, runs: Iterable[tuple[str, str, Figure]], table: Beginning
) -> list[str]:
    """Write name, table and figure of all runs, once all of them are there; return their files."""
    from nrs_design.reporting.images import to_png, to_svg_file

    if folder is None:
        return []
    outputs: list[Output] = []
    for name, text, figure in runs:
        contents: list[str | bytes] = [text, to_svg_file(figure), to_png(figure)]
        places = zip(_places(folder, name, table).items(), contents, strict=True)
        outputs += [(place, content, kind) for (place, kind), content in places]
    write_outputs(outputs)
    note(f"written to {folder}")
    return [str(path) for path, _, _ in outputs]
