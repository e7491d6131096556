import numpy as np

from nrs_design.reporting.figures.simulated import Panel, draw_panels

T = np.linspace(0, 10, 20_001)


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
