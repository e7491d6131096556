"""What the gains of an admittance give up."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from nrs_design.axis import labelled
from nrs_design.design.landscape import alternatives
from nrs_design.reporting.document import Block, Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked

if TYPE_CHECKING:
    from nrs_design.design.analysis import ImpedanceAnalysis
    from nrs_design.pipeline.design import Designed
    from nrs_design.spec import LoadedSpec

_GAINS = ("Mt", "Bt")
_TEXT = (
    "The cost weighs how far the displayed impedance is from the desired one against the mean "
    "sensitivity, up to the bandwidth. Where gains may be chosen, each row of a table is the best "
    "for something else: what it gains there, it gives up in the other columns. The cost is that "
    "of the thesis: its loop G Ze H Y at nominal values, in continuous time and without a load "
    "of the motor. Floating point, goals left out; no part of the proof."
)
_BOUND = "{} is on its {} bound: that chose it, not the cost."


def landscape_section(designed: Designed, items: tuple[ImpedanceAnalysis, ...]) -> Section | None:
    """Show alternatives of the impedance controllers; None where no gain was chosen."""
    # Where nothing may be chosen, nothing else is the best for anything.
    chosen = [i for i in items if not all(getattr(i.given, gain).fixed for gain in _GAINS)]
    if not chosen:
        return None
    blocks: list[Block] = [Paragraph(_TEXT)]
    for item in chosen:
        blocks.append(_table(designed.loaded, item))
        if remarks := " ".join(_remarks(item)):
            blocks.append(Paragraph(remarks))
    return Section("What the gains give up", tuple(blocks))


def _remarks(item: ImpedanceAnalysis) -> Iterator[str]:
    """Say which gains were not chosen by the cost."""
    for gain in _GAINS:
        bounds = getattr(item.given, gain)
        if bounds.fixed:
            yield f"{gain} is given by the spec, not optimized."
            continue
        for side, end in (("lower", bounds.min), ("upper", bounds.max)):
            if getattr(item.optimum, gain) == end.si:
                yield _BOUND.format(gain, side)


def _table(loaded: LoadedSpec, item: ImpedanceAnalysis) -> Table:
    at = ("controllers", item.name)
    rows = tuple(
        (
            other.name,
            linked(loaded, number(other.Mt, 4), *at, "Mt"),
            linked(loaded, number(other.Bt, 4), *at, "Bt"),
            # What follows from several lines leads to the controller, which names the others.
            *(
                linked(loaded, text, *at)
                for text in (
                    number(other.cost, 4),
                    number(other.displayed, 3),
                    number(other.sensitivity, 3),
                )
            ),
        )
        for other in alternatives(item.problem, item.Mt, item.Bt)
    )
    columns = (
        "Gains",
        labelled("Mt [kg·m²]"),
        labelled("Bt [N·m·s/rad]"),
        "Cost [1]",
        "Off the desired impedance, mean [decades]",
        "Mean sensitivity [1]",
    )
    return Table(f"What is given up: {item.name}", columns, rows)
