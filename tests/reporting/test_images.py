import pytest
from matplotlib.figure import Figure

from nrs_design.reporting.images import render_png, render_svg_file


@pytest.mark.slow
def test_a_figure_is_a_png_of_full_size(report):
    (item, *_) = report("inconclusive").illustrations
    data = render_png(item.figure)
    assert data.startswith(b"\x89PNG")
    assert int.from_bytes(data[16:20]) == 1080
    assert render_png(item.figure) == data


def test_the_last_digit_of_a_layout_leaves_no_trace():
    """It follows addresses in memory, so that the same figure has several."""
    texts = []
    for bottom in (0.125, 0.125 + 1e-14):
        figure = Figure()
        axes = figure.add_axes((0.125, bottom, 0.75, 0.75))
        axes.plot([0.0, 1.0], [0.0, 1.0])
        texts.append(render_svg_file(figure))
    assert texts[0] == texts[1]
    assert "#outline-0)" in texts[0]
