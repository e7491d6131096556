import numpy as np
import pytest

from nrs_design.reporting.figures.panels import Curve, Panel, PanelColumn, draw_panels

T = np.linspace(0, 10, 20_001)


def lines(axes, label):
    return [line for line in axes.get_lines() if line.get_label() == label]


def test_a_short_peak_is_drawn_however_long_the_run():
    y = np.zeros_like(T)
    y[12_345] = 1.0
    figure = draw_panels([PanelColumn("", (Panel("y", (Curve(T, y, "y"),)),), (0, 10))])
    (line,) = lines(figure.axes[0], "y")
    assert len(line.get_xdata()) < 1000
    assert line.get_ydata().max() == 1.0
    assert line.get_xdata()[line.get_ydata().argmax()] == T[12_345]


def test_a_gap_stays_a_gap():
    y = np.where((T > 4) & (T < 6), np.nan, 1.0)
    figure = draw_panels([PanelColumn("", (Panel("y", (Curve(T, y, "y"),)),), (0, 10))])
    (line,) = lines(figure.axes[0], "y")
    assert np.isnan(line.get_ydata()).any()
    assert not (
        np.isfinite(line.get_ydata()) & (line.get_xdata() > 4.1) & (line.get_xdata() < 5.9)
    ).any()


def test_limits_stays_instants_and_the_second_scale():
    panel = Panel(
        "Torque [N m]",
        (Curve(T, T, "one"), Curve(np.array([5.0]), np.array([3.0]), "printed", printed=True)),
        limits=(0.3,),
        limit="T_max",
        other=("Force [N]", 4.0),
    )
    stays = ((0.0, 6.0, "position"), (6.0, 6.01, "force"))
    figure = draw_panels([PanelColumn("a", (panel,), (0, 10), stays, (7.0,))])
    axes = figure.axes[0]
    assert [text.get_text() for text in axes.texts] == ["position"]
    assert sum(patch.get_alpha() is not None for patch in axes.patches) == 2
    (scale,) = axes.child_axes
    assert scale.get_ylabel() == "Force [N]"
    assert scale.get_ylim() == pytest.approx([4 * end for end in axes.get_ylim()])
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [
        *("one", "printed", "T_max", "printed instant"),
        *("controller: position", "controller: force"),
    ]


def test_what_stands_alone_is_named_by_its_axis():
    column = PanelColumn("", (Panel("Depth [mm]", (Curve(T, T, "depth"),)),), (0, 10))
    figure = draw_panels([column, column])
    assert figure.legends == []
    assert [axes.get_ylabel() for axes in figure.axes] == ["Depth [mm]", ""]
