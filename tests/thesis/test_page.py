from nrs_design.thesis.comparison import PrintedRow, Recomputed, judge
from nrs_design.thesis.table import counts_line, format_within, render_page, topic_rows

ROWS = topic_rows("specimens")


def test_page_is_self_contained():
    page = render_page(ROWS)
    assert page.startswith("<!DOCTYPE html>")
    assert "://" not in page
    assert "default-src 'none'" in page
    assert not any(word in page for word in ("<script", "<link", "<img", "@import"))


def test_page_shows_every_row():
    page = render_page(ROWS)
    for row in ROWS:
        assert row.name in page
        assert row.printed in page
        assert row.verdict in page
        assert row.limit in page
        assert row.precision in page
    assert counts_line(ROWS) in page
    assert "converted by machine" in page


def test_hostile_text_is_escaped():
    printed = PrintedRow("not reproducible", "<script>alert(1)</script>", "1", '"&', note="a < b")
    row = judge(printed, Recomputed())
    page = render_page((row,))
    assert "<script" not in page
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in page
    assert "&#34;&amp;" in page
    assert "a &lt; b" in page


def test_deviation_text():
    found = [format_within(d, "0.1 %") for d in (None, 0.0, 0.000468)]
    assert found == ["", "0 (0.1 %)", "4.7e-04 (0.1 %)"]


def test_a_telephone_names_every_value():
    """Below 48rem the head of the table is gone, and each cell says what it is."""
    page = render_page(ROWS)
    for column in ("Printed", "Recomputed", "Unit", "Off the print", "Off our reference"):
        assert page.count(f'<td data-label="{column}"') == len(ROWS)
    assert "attr(data-label)" in page
