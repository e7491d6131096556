import re

from nrs_design.thesis.gallery.page import count_outcomes, gallery_page, summarize_gallery


def test_the_page_has_every_figure_statement_and_input(counterparts):
    page = gallery_page(counterparts)
    assert page.startswith("<!DOCTYPE html>")
    for number in range(14, 35):
        assert f'<th scope="row">6.{number}</th>' in page
    for one in counterparts:
        for text in (*one.given, *one.chosen):
            assert text.replace("'", "&#39;").replace("<", "&lt;").replace(">", "&gt;") in page
    rows = sum(len(one.statements) for one in counterparts)
    assert len(re.findall(r'<td data-label="outcome">', page)) == rows
    assert sum(count_outcomes(counterparts).values()) == rows


def test_the_page_fetches_nothing_and_says_so(counterparts):
    page = gallery_page(counterparts)
    assert "default-src 'none'" in page
    assert "http" not in page.replace("http-equiv", "")
    figures = sum(len(one.illustrations) for one in counterparts)
    assert page.count('role="img"') == figures


def test_fields_are_those_of_the_page(counterparts):
    fields = summarize_gallery(counterparts)
    assert fields[0]["figures"] == ["6.14"]
    assert fields[0]["statements"][1] == {
        "quantity": "displayed impedance at 26 s, N m s/rad",
        "printed": "2.1372",
        "simulated": "2.15 (+0.6 %)",
        "outcome": "reproduced",
        "why": "",
    }
    assert fields[0]["runs"] == ["figure-6-14.csv"]
