"""The files of a run: its table, and its figure twice."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.output import PNG, SVG, Beginning, Output, check_place, write_outputs

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True)
class RunFiles:
    """Where the files of one run go: ``NAME.csv``, ``.svg`` and ``.png``."""

    folder: Path
    name: str
    table: Beginning  # How a table begins that may be replaced

    def places(self) -> list[tuple[Path, Beginning]]:
        """Return the files, and how one that may be replaced begins."""
        kinds: dict[str, Beginning] = {"csv": self.table, "svg": SVG, "png": PNG}
        return [(self.folder / f"{self.name}.{ending}", kind) for ending, kind in kinds.items()]

    def check(self) -> None:
        """Refuse, before the work, a folder in which something else stands at one of the places."""
        for place, kind in self.places():
            check_place(place, kind)

    def outputs(self, table: str, figure: Figure) -> list[Output]:
        """Return what is written."""
        from nrs_design.reporting.images import to_png, to_svg_file

        contents: list[str | bytes] = [table, to_svg_file(figure), to_png(figure)]
        places = zip(self.places(), contents, strict=True)
        return [(place, content, kind) for (place, kind), content in places]


def write_runs(outputs: Iterable[Output]) -> list[str]:
    """Write the files of all runs, once all of them are there; return their names."""
    listed = list(outputs)
    write_outputs(listed)
    return [str(path) for path, _, _ in listed]
