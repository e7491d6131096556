from __future__ import annotations

from nrs_design.reporting import render_png


def test_every_figure_is_a_png_of_full_size(report):
    images = render_png(report("inconclusive"))
    assert list(images) == [item.name for item in report("inconclusive").illustrations]
    for data in images.values():
        assert data.startswith(b"\x89PNG")
        assert int.from_bytes(data[16:20]) == 1080


def test_same_report_gives_the_same_bytes(report):
    assert render_png(report("refuted")) == render_png(report("refuted"))
