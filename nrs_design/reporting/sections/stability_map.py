"""For which stiffness and delay a sampled loop holds."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

from nrs_design.axis import unit
from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.bounds import lower, upper
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.style import BLUE, INK, MUTED, VERMILLION, legend, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle as Cell

    from nrs_design.pipeline.stability_map import StabilityMap
    from nrs_design.spec import LoadedSpec

_TEXT = (
    "Each cell was decided in exact arithmetic, or follows from one that was: it takes every "
    "stiffness of every contact from its lower end to the cell's upper end, and every age of the "
    "force sample from the shortest declared one to the cell's. So a proof holds for all cells to "
    "the left and below, a refutation for all to the right and above. Gains, ranges of the motor "
    "and rules of switching are those of the spec; its disturbances are left out, and no bound on "
    "the force was looked at. Undecided says nothing: a longer search may decide. No cell but the "
    "certificate of the spec itself is kept as a file."
)
_CAPTION = (
    "P proved, R refuted, ? undecided; the framed cell ends where the declared ranges end. The age "
    "is in samples."
)


def stability_map_section(loaded: LoadedSpec, found: StabilityMap) -> Section:
    """Show the map, and for each age the stiffness that is proved and refuted.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec that it is about.
    found : StabilityMap
        As `nrs_design.pipeline.stability_map.run_stability_map` finds it.
    """
    verdicts = (Verdict.PROVED, Verdict.REFUTED)
    words = [
        f"{name} [{unit('N·m/rad')}], {verdict}"
        for verdict in verdicts
        for name, _, _ in found.contacts
    ]
    rows = tuple(
        (
            linked(loaded, str(delay), "sampling", "delay"),
            *chain.from_iterable(_ends(loaded, found, row, verdict) for verdict in verdicts),
        )
        for row, delay in enumerate(found.delays)
    )
    columns = ("Oldest force sample", *words)
    return Section(
        "Stiffness and delay",
        (
            Paragraph(_TEXT),
            Illustration(
                "stability-map",
                "Proved and refuted",
                _CAPTION + _aside(found),
                _draw_stability_map(found),
            ),
            Table("Stiffness that is proved, and that is refuted", columns, rows),
        ),
    )


def _aside(found: StabilityMap) -> str:
    if not found.refuted_in:
        return ""
    return (
        f" What is refuted, is so {found.refuted_in}, where the environment would have to pull; "
        "with contact that may be lost, these cells are undecided."
    )


def _ends(loaded: LoadedSpec, found: StabilityMap, row: int, verdict: Verdict) -> list[str]:
    """Return the furthest range that is proved, or the nearest refuted, for every contact."""
    held = [f for c, f in enumerate(found.factors) if found.verdicts[row, c] is verdict]
    if not held:
        return ["–"] * len(found.contacts)
    factor = max(held) if verdict is Verdict.PROVED else min(held)
    outside = verdict is Verdict.REFUTED
    return [
        # Proved ranges are rounded inward, refuted ones outward.
        linked(
            loaded,
            f"{(lower if outside else upper)(low)} to "
            f"{(upper if outside else lower)(factor * high)}",
            *("environments", name, "stiffness"),
        )
        for name, low, high in found.contacts
    ]


# Colour, letters and hatching: not only a colour tells how a cell stands.
_LOOKS = {
    Verdict.PROVED: (BLUE, "", "proved", "P"),
    Verdict.INCONCLUSIVE: (MUTED, "..", "undecided", "?"),
    Verdict.REFUTED: (VERMILLION, "//", "refuted", "R"),
}


@styled
def _draw_stability_map(found: StabilityMap) -> Figure:
    """Draw a cell for each decision, the declared one framed."""
    from nrs_design.plotting import Rectangle

    figure, axes = new_axes(1.6 + 0.42 * len(found.delays))
    for (row, column), verdict in found.verdicts.items():
        axes.add_patch(_cell(verdict, (column - 0.5, row - 0.5)))
        sign = _LOOKS[verdict][3]
        axes.text(column, row, sign, ha="center", va="center", fontsize=9, color=INK)
    for verdict in dict.fromkeys(found.verdicts.values()):
        label = f"{_LOOKS[verdict][3]}: {_LOOKS[verdict][2]}"
        # Outside the axes: for the legend alone.
        axes.add_patch(_cell(verdict, (-9.0, -9.0), label))
    if 1 in found.factors and found.delay in found.delays:
        corner = (found.factors.index(1) - 0.5, found.delays.index(found.delay) - 0.5)
        frame = Rectangle(corner, 1, 1, fill=False, edgecolor=INK, linewidth=2.0, zorder=3)
        frame.set_label("declared upper ends")
        axes.add_patch(frame)
    axes.set(xlim=(-0.5, len(found.factors) - 0.5), ylim=(-0.5, len(found.delays) - 0.5))
    axes.set_xticks(range(len(found.factors)), list(map(str, found.factors)))
    axes.set_yticks(range(len(found.delays)), [str(delay) for delay in found.delays])
    axes.grid(visible=False)
    axes.set(xlabel="Largest stiffness, over the declared one [1]", ylabel="Oldest force sample")
    legend(figure, axes, 2)
    return figure


def _cell(verdict: Verdict, corner: tuple[float, float], label: str = "") -> Cell:
    from nrs_design.plotting import Rectangle

    tint, hatch, _, _ = _LOOKS[verdict]
    cell = Rectangle(corner, 1, 1, facecolor=tint, edgecolor=INK, linewidth=0.5, alpha=0.3)
    cell.set_hatch(hatch)
    cell.set_label(label)
    return cell
