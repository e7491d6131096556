import numpy as np

from nrs_design.reporting.figures.simulated import Panel, draw_panels

T = np.linspace(0, 10, 20_001)


def test_a_short_peak_is_drawn_however_long_the_run():
    y = np.zeros_like(T)
    y[12_345] = 1.0
    figure = draw_panels(T, [Panel("y", {"y": y})])
    (line,) = [line for line in figure.axes[0].get_lines() if line.get_label() == "y"]
    assert len(line.get_xdata()) < 1000
    assert line.get_ydata().max() == 1.0
    assert line.get_xdata()[line.get_ydata().argmax()] == T[12_345]


def test_limits_and_stays():
    panel = Panel("Torque [N m]", {"one": T, "two": T}, limits=(0.3,))
    stays = ((0.0, 6.0, "position"), (6.0, 6.01, "force"))
    figure = draw_panels(T, [panel], stays, "a")
    axes = figure.axes[0]
    assert [text.get_text() for text in axes.texts] == ["position"]
    assert sum(patch.get_alpha() is not None for patch in axes.patches) == 2
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == [
        *("one", "two", "limit of the spec"),
        *("controller: position", "controller: force"),
    ]


def test_what_stands_alone_is_named_by_its_axis():
    figure = draw_panels(T, [Panel("Depth [mm]", {"depth": T})])
    assert figure.legends == []
    assert [axes.get_ylabel() for axes in figure.axes] == ["Depth [mm]"]
