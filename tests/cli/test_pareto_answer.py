"""Points of a trade-off as they are printed, also of a curve without any."""

from dataclasses import dataclass, field
from fractions import Fraction
from types import SimpleNamespace

import pytest

from nrs_design.cli.pareto_answer import show, table_text
from nrs_design.design.objective import Objective
from nrs_design.pipeline.trade_off import TradeOffCurve
from nrs_design.pipeline.trade_point import is_dominated
from nrs_design.reporting.figures.trade_off import draw_trade_off

BOTH = (Objective.STIFFNESS, Objective.NOISE)
GAINS = {("a", "Bt"): "2 N*m*s/rad", ("motion", "Kp"): "9 rpm/rad"}
RESULT = SimpleNamespace(
    certificate=SimpleNamespace(id="c" * 64),
    loaded=SimpleNamespace(spec=SimpleNamespace(kind="other"), text="text"),
)


@dataclass(frozen=True)
class Point:
    """What is read of a point."""

    cost: float
    high: float
    noise: float | None = 0.3
    force: Fraction | None = None
    share: Fraction | None = None
    rate: Fraction = Fraction(1)
    delay: Fraction | None = Fraction(1, 500)
    at_bounds: tuple = ()
    gains: dict = field(default_factory=lambda: GAINS)
    result: object = field(default_factory=lambda: RESULT)

    @property
    def stiffness(self):
        return {"soft": Fraction(self.high)}

    def value(self, objective):
        return {Objective.STIFFNESS: self.high, Objective.NOISE: self.noise}[objective]


LOADED = SimpleNamespace(
    spec=SimpleNamespace(name="x", kind="other"), path="x.nrs.yaml", sha256="0", text=""
)
FIRST = TradeOffCurve(Objective.STIFFNESS, True, 0.2, ())
SECOND = TradeOffCurve(
    Objective.STIFFNESS,
    False,
    0.2,
    (
        Point(0.2, 40.0),
        Point(0.21, 50.0, share=Fraction(1, 20), at_bounds=(("motion Kp", "upper"),)),
    ),
)


def test_a_curve_without_points_stands_beside_one_with_some(capsys):
    """The contacts were once taken from the first curve, whatever it had."""
    show(LOADED, BOTH, (FIRST, SECOND), {"given.nrs.yaml": None, "own.nrs.yaml": Point(0.3, 41.0)})
    said = capsys.readouterr().out
    assert "nothing was proved at these costs" in said
    assert "soft: k up to" in said
    assert "5.0 %" in said
    assert "given.nrs.yaml: nothing was proved of it" in said
    assert "motion Kp is on its upper bound in some points" in said


def test_the_table_has_all_points():
    rows = table_text((FIRST, SECOND), {"own.nrs.yaml": Point(0.3, 41.0)}, BOTH).splitlines()
    assert [row.split(",")[:3] for row in rows[1:]] == [
        ["stiffness", "0.2", "40.0"],
        ["stiffness", "0.21", "50.0"],
        ["own.nrs.yaml", "0.3", "41.0"],
    ]
    assert rows[0].endswith("a.Bt,motion.Kp")


@pytest.mark.parametrize(
    ("point", "dominated"),
    [
        (Point(0.2, 40.0), False),
        (Point(0.22, 50.0), True),  # As stiff for less
        (Point(0.22, 51.0), False),
        (Point(0.22, 50.0, noise=0.2), False),  # Quieter
        (Point(0.2, 40.0, noise=0.4), True),
    ],
)
def test_what_another_design_is_better_than(point, dominated):
    assert is_dominated(point, [*SECOND.points, point], BOTH) == dominated


def test_a_panel_for_each_objective():
    figure = draw_trade_off((FIRST, SECOND), {"own": Point(0.3, 41.0), "none": None}, BOTH)
    stiffness, noise = figure.axes
    assert stiffness.get_ylabel().startswith("Stiffness proved up to")
    assert noise.get_ylabel().startswith("Noise")
    # Two curves of the stiffness, its ring, and the given design; of the noise that alone.
    assert [len(axes.lines) for axes in figure.axes] == [4, 1]
