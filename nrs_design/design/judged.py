"""Which of the shown margins are proved, and which are floating point, in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from nrs_design.design.laws.law import AbstractControllerAnalysis
from nrs_design.design.measures import MEANING


def computed(items: Sequence[AbstractControllerAnalysis]) -> Iterator[str]:
    """Yield how the values of controllers were found.

    Parameters
    ----------
    items : sequence of AbstractControllerAnalysis
        The controllers that are shown.
    """
    proved: dict[str, list[str]] = {}
    for item in items:
        if titles := [found.measure.title for found in item.judged if found.proved is not None]:
            proved.setdefault(", ".join(titles), []).append(item.name)
    for said, names in proved.items():
        yield (
            f"Proved in exact arithmetic for all values in the ranges, each of them constant, of "
            f"{', '.join(names)}: {said}."
        )
    yield f"{'All else: computed' if proved else 'Computed'}{MEANING[-1].removeprefix('Computed')}"
