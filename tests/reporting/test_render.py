from __future__ import annotations

import re

import pytest

from nrs_design.reporting import render_html
from tests.reporting.conftest import ROOT, report_of

CASES = ["proved", "force", "refuted", "inconclusive", "discrete", "marginal"]


def test_same_spec_gives_the_same_bytes(report):
    path = ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml"
    page = render_html(report("proved"))
    assert page == render_html(report("proved"))
    assert page == render_html(report_of(path))


@pytest.mark.parametrize("case", CASES)
def test_page_is_self_contained(report, case):
    page = render_html(report(case))
    assert "<script" not in page
    assert "http://" not in page
    assert "https://" not in page
    assert "@import" not in page
    assert not re.search(r'\b(?:src|href)="(?!#|data:)', page)


@pytest.mark.parametrize("case", CASES)
def test_ids_are_unique_and_references_resolve(report, case):
    page = render_html(report(case))
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids))
    used = set(re.findall(r'href="#([^"]+)"', page)) | set(re.findall(r"url\(#([^)]+)\)", page))
    assert used
    assert used <= set(ids)


@pytest.mark.parametrize("case", CASES)
def test_page_shows_verdict_and_every_figure(report, case):
    page = render_html(report(case))
    assert f'<p class="badge">{report(case).verdict}</p>' in page
    names = [item.name for item in report(case).illustrations]
    assert page.count("<svg ") == len(names)
    assert all(f'<figure id="{name}"' in page for name in names)


def test_hostile_title_is_escaped(report):
    page = render_html(report("discrete"))
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; &#34;it&#39;s&#34; {{ 7*7 }}" in page


def test_no_value_is_left_undefined(report):
    for case in CASES:
        text = re.sub(r"<(style|svg).*?</\1>", "", render_html(report(case)), flags=re.DOTALL)
        assert not re.search(r">(None|nan|inf)<", text)
