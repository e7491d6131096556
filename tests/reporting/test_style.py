from nrs_design.reporting.images import render_png, render_svg_file
from nrs_design.reporting.style import MAX_SERIES, color, curve, legend, marker, new_axes, styled

FORMULA = r"a$\frac{$ and $x$"


def test_so_many_series_are_told_apart():
    looks = {(color(i), marker(i)) for i in range(MAX_SERIES)}
    assert len(looks) == MAX_SERIES


def test_curves_on_top_of_each_other_show_their_markers_in_turn():
    marked = [curve(index, 3, 400)["markevery"] for index in range(3)]
    places = [set(range(400)[start::step]) for start, step in marked]
    assert all(len(place) == 8 for place in places)
    assert len(set.union(*places)) == 24


@styled
def named(names):
    figure, axes = new_axes()
    for index, name in enumerate(names):
        axes.plot([0, 1], [index, 1], label=name)
    axes.set_title(names[0] if names[0].isascii() else "")
    legend(figure, axes)
    return figure


def test_a_name_is_no_formula():
    figure = named([FORMULA, "$$"])
    assert render_png(figure) == render_png(figure)
    assert [t.get_text() for t in figure.legends[0].get_texts()] == [FORMULA, "$$"]
    assert not any(t.get_parse_math() for t in figure.legends[0].get_texts())


def test_a_legend_holds_full_names_within_the_figure_beside_no_data():
    names = [f"a-controller-with-a-long-name/tissue-{i}/k-min/Mt-max/Bt-min" for i in range(14)]
    figure = named(names)
    (box,) = figure.legends
    shown = ["".join(t.get_text().splitlines()) for t in box.get_texts()]
    assert shown == names
    extent = box.get_window_extent()
    assert extent.x0 >= 0
    assert extent.x1 <= figure.bbox.width
    assert extent.y0 >= 0
    (axes,) = figure.axes
    assert extent.y1 < axes.get_tightbbox().y0
    # The legend makes the figure higher; the axes keep their size.
    assert axes.bbox.height > named(["a", "b"]).axes[0].bbox.height - 8


def test_letters_that_the_font_lacks_are_escaped():
    """matplotlib would warn and draw a box."""
    figure = named(["中", "b"])
    assert figure.legends[0].get_texts()[0].get_text() == "\\u4e2d"
    assert render_svg_file(figure) == render_svg_file(figure)
