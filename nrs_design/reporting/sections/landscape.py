"""What the choice of an admittance gives up, and how much delay it bears."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.design.landscape import alternatives, map_cost
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.landscape import draw_cost, draw_delay_borne
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked

if TYPE_CHECKING:
    from nrs_design.design.analysis import ImpedanceAnalysis
    from nrs_design.pipeline import Designed
    from nrs_design.spec import LoadedSpec

# More maps than these fill a page with what is nearly alike.
_DRAWN = 4
_GAINS = ("Mt", "Bt")
_TEXT = (
    "The cost weighs how far the displayed impedance is from the desired one against the mean "
    "sensitivity, up to the bandwidth. Where gains may be chosen, each row of a table is the best "
    "for something else: what it gains there, it gives up in the other columns. The cost is that "
    "of the thesis: its loop G Ze H Y at nominal values, in continuous time and without a load "
    "of the motor. Floating point, goals left out; no part of the proof."
)
_MAP = (
    "Lines of equal cost, with the values of some. Shaded: the loop that is proved is unstable at "
    "its nominal values."
)
_BOX = (
    " The dashed box is where the spec allows the gains to be; an optimum on its edge was chosen "
    "by the bound, not by the cost."
)
_DELAY = (
    "A curve ends at zero where the loop is unstable without any dead time. Below its curve, a "
    "controller bears that dead time in contact of that stiffness, constant and by itself, at "
    "every corner of the other ranges of its contact and of the motor; a sampled one bears it "
    "beside the age of its force sample, in whole samples. Dotted: "
    "the stiffest contact that it is designed for."
)


def landscape_section(designed: Designed, items: tuple[ImpedanceAnalysis, ...]) -> Section:
    """Show cost, alternatives and delay of the impedance controllers.

    Parameters
    ----------
    designed : Designed
        With the sampling, if any, and the places of all that the spec says.
    items : tuple of ImpedanceAnalysis
        At least one.
    """
    blocks: list[Block] = [Paragraph(_TEXT)]
    for item in items[:_DRAWN]:
        blocks.append(_map(item))
        # Where nothing may be chosen, nothing else is the best for anything.
        if len(_given(item)) < len(_GAINS):
            blocks.append(_table(designed.loaded, item))
    sampling = designed.spec.sampling
    sampled = None if sampling is None else float(sampling.oldest)
    blocks.append(
        Illustration(
            "delay-borne",
            "Dead time over stiffness",
            _DELAY,
            draw_delay_borne(items[:_DRAWN], sampled),
        )
    )
    return Section("What the gains give up", tuple(blocks))


def _map(item: ImpedanceAnalysis) -> Illustration:
    found = map_cost(item.problem, item.requirement, item.Mt, item.Bt)
    remarks = [f"{gain} is on its {side} bound." for gain, side in _on_bounds(item)]
    if given := _given(item):
        verb = "is" if len(given) == 1 else "are"
        remarks.append(f"{' and '.join(given)} {verb} given by the spec, not optimized.")
    held = " ".join(remarks)
    return Illustration(
        f"cost-{item.name}",
        f"Cost over Mt and Bt: {item.name}",
        f"{_MAP}{'' if item.given.Mt.fixed or item.given.Bt.fixed else _BOX} {held}".rstrip(),
        draw_cost(item, found),
    )


def _given(item: ImpedanceAnalysis) -> list[str]:
    return [gain for gain in _GAINS if getattr(item.given, gain).fixed]


def _on_bounds(item: ImpedanceAnalysis) -> list[tuple[str, str]]:
    found = []
    for gain, bounds, value in (
        ("Mt", item.given.Mt, item.optimum.Mt),
        ("Bt", item.given.Bt, item.optimum.Bt),
    ):
        if not bounds.fixed:
            ends = (("lower", bounds.min), ("upper", bounds.max))
            found += [(gain, side) for side, end in ends if value == end.si]
    return found


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
        "Mt [kg·m²]",
        "Bt [N·m·s/rad]",
        "Cost [1]",
        "Off the desired impedance, mean [decades]",
        "Mean sensitivity [1]",
    )
    return Table(f"What is given up: {item.name}", columns, rows)
