from dataclasses import replace

from nrs_design.reproduction.comparison import hardware_only
from nrs_design.reproduction.page import format_deviation, render_page
from nrs_design.reproduction.specimens import rows


def test_page_is_self_contained():
    page = render_page(rows())
    assert page.startswith("<!DOCTYPE html>")
    assert "://" not in page
    assert not any(word in page for word in ("<script", "<link", "<img", "@import"))


def test_page_shows_every_row():
    page = render_page(rows())
    for row in rows():
        assert row.name in page
        assert row.printed in page
        assert row.verdict in page
        assert row.tolerance in page
    assert "4 reproduced" in page


def test_page_is_the_same_every_time():
    assert render_page(rows()) == render_page(rows())


def test_hostile_text_is_escaped():
    row = replace(hardware_only("<script>alert(1)</script>", "1", '"&', "%"), note="a < b")
    page = render_page((row,))
    assert "<script" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "&#34;&amp;" in page
    assert "a &lt; b" in page


def test_deviation_text():
    assert [format_deviation(d) for d in (None, 0.0, 0.000468)] == ["", "0", "4.7e-04"]


def test_the_page_of_figures_is_linked_where_there_is_one():
    assert "<a " not in render_page(rows())
    page = render_page(rows(), "my%20figures/figures.html")
    assert '<a href="my%20figures/figures.html">' in page
    assert "default-src 'none'" in render_page(rows())


def test_a_telephone_names_every_value():
    """Below 48rem the head of the table is gone, and each cell says what it is."""
    page = render_page(rows())
    for column in ("Printed", "Recomputed", "Unit", "Deviation", "Tolerance"):
        assert page.count(f'<td data-label="{column}"') == len(rows())
    assert "attr(data-label)" in page
