from __future__ import annotations

import re

import pytest

from nrs_design.reporting import render_html
from tests.reporting.conftest import KINDS, ROOT, report_of

CASES = ["proved", "force", "refuted", "discrete", "marginal", *KINDS]


def test_same_spec_gives_the_same_bytes(report, page):
    path = ROOT / "specs/neuroboscope/soft-tissue.nrs.yaml"
    assert page("proved") == render_html(report("proved"))
    assert page("proved") == render_html(report_of(path))


@pytest.mark.parametrize("case", ["polynomial", "dwell", "mixture"])
def test_every_kind_gives_the_same_bytes(page, tmp_path, case):
    path = tmp_path / f"{case}.nrs.yaml"
    path.write_text(f"kind: switched-system\nname: {case}\n{KINDS[case]}")
    assert page(case) == render_html(report_of(path))


@pytest.mark.parametrize("case", CASES)
def test_page_is_self_contained(page, case):
    html = page(case)
    assert "<script" not in html
    assert "http://" not in html
    assert "https://" not in html
    assert "@import" not in html
    assert not re.search(r'\b(?:src|href)="(?!#|data:)', html)


@pytest.mark.parametrize("case", CASES)
def test_ids_are_unique_and_references_resolve(page, case):
    html = page(case)
    ids = re.findall(r'\bid="([^"]+)"', html)
    assert len(ids) == len(set(ids))
    used = set(re.findall(r'href="#([^"]+)"', html)) | set(re.findall(r"url\(#([^)]+)\)", html))
    assert used
    assert used <= set(ids)


@pytest.mark.parametrize("case", CASES)
def test_page_shows_verdict_and_every_figure(report, page, case):
    html = page(case)
    assert f'<p class="badge">{report(case).verdict}</p>' in html
    names = [item.name for item in report(case).illustrations]
    assert html.count("<svg ") == len(names)
    assert all(f'<figure id="{name}"' in html for name in names)
    assert html.count('<p class="remark">') == len(report(case).remarks)


def test_hostile_title_is_escaped(page):
    html = page("discrete")
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; &#34;it&#39;s&#34; {{ 7*7 }}" in html


def test_no_value_is_left_undefined(page):
    for case in CASES:
        text = re.sub(r"<(style|svg).*?</\1>", "", page(case), flags=re.DOTALL)
        assert not re.search(r">(None|nan|inf)<", text)
