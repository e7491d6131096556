import base64
import hashlib
import html
import re
from dataclasses import replace
from importlib.resources import files

import pytest

from nrs_design.printable import visible
from nrs_design.reporting import render_html
from nrs_design.reporting.document import Section, Table
from tests.reporting.conftest import KINDS, report_of, slow
from tests.support import COMMUTING, SOFT_TISSUE

# Each makes another figure of the run, or another sentence, than those before it.
SHORT = ["proved", "refuted", "discrete", "polynomial", "dwell", "mixture"]
CASES = [
    *SHORT,
    slow("force"),
    slow("marginal"),
    *(slow(case) for case in KINDS if case not in SHORT),
]


@pytest.mark.parametrize("path", [COMMUTING, pytest.param(SOFT_TISSUE, marks=pytest.mark.slow)])
def test_same_spec_gives_the_same_bytes(path):
    assert render_html(report_of(path)) == render_html(report_of(path))


@pytest.mark.parametrize("case", CASES)
def test_a_page_is_whole_and_fetches_nothing(report, page, case):
    text, made = page(case), report(case)
    assert text.count("<script") == 1
    assert not re.search(r"https?://|@import", text)
    assert not re.search(r'\b(?:src|href)="(?!#|data:)', text)
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert len(ids) == len(set(ids))
    used = set(re.findall(r'href="#([^"]+)"', text)) | set(re.findall(r"url\(#([^)]+)\)", text))
    assert used
    assert used <= set(ids)
    plain = re.sub(r"<(style|svg|script).*?</\1>", "", text, flags=re.DOTALL)
    assert not re.search(r">(None|nan|inf)<", plain)
    names = [item.name for item in made.illustrations]
    assert text.count("<svg ") == len(names)
    assert all(f'<figure id="{name}"' in text for name in names)
    assert text.count('<p class="remark">') == len(made.remarks)


@pytest.mark.parametrize("case", CASES)
def test_verdict_sentences_and_lights_come_first_and_contents_in_order(report, page, case):
    text, made = page(case), report(case)
    assert f'<p class="badge">{made.verdict}</p>' in text
    order = ("summary", "key", "lights", "claim")
    places = [text.index(f'class="{name}"') for name in order]
    assert places == sorted(places)
    assert text.count('<p class="summary">') == 1
    assert text.count('aria-hidden="true"') == len(made.lights)
    listed = [html.unescape(title) for title in re.findall(r"<h2>([^<>]+)</h2>", text)]
    assert listed == ["The exact statement", *(visible(part.title) for part in made.sections)]


def test_the_page_runs_its_own_script_and_no_other(page):
    """The policy names the hash of the one script; a script of a hostile title does not run."""
    text = page("discrete")
    script = re.search(r"<script>(.*)</script>", text, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = f"img-src data:; script-src 'sha256-{digest}'"
    assert f"default-src 'none'; style-src 'unsafe-inline'; {policy}" in text
    assert len(script) < 300_000
    assert not re.search(r"<[^>]*\son\w+=", text)


def test_a_page_holds_what_the_id_of_its_certificate_is_the_hash_of(page, report):
    """And its check is short: the page grows by it and by the numbers, in which quotes stay."""
    numbers = re.search(r'<pre id="numbers" hidden>(.*)</pre>', page("proved"))[1]
    text = html.unescape(numbers)
    assert text == report("proved").certificate
    assert hashlib.sha256(text.encode()).hexdigest() in dict(report("proved").facts).values()
    assert len(numbers) < 1.01 * len(text)
    script = files("nrs_design.reporting").joinpath("templates/check.js").read_text("utf-8")
    assert script in page("proved")
    assert len(script) < 21_400
    assert len(script.splitlines()) <= 250


def test_every_gain_leads_to_its_line_of_the_spec(page):
    """Gains, what they achieve, eigenvalues, margins and assumptions: every table of the spec."""
    text = page("proved")
    links = re.findall(r'<a href="#line-(\d+)"[^>]*>([^<]+)</a>', text)
    said = dict(re.findall(r'<span id="line-(\d+)">([^<]*)</span>', text))
    assert len(links) == 94
    where = {value: said[line].strip() for line, value in links}
    assert where["2060"].startswith("derivative_gain: 2060")
    assert where["2.15"].startswith("insertion:")
    assert where["43.0356"].startswith("withdrawal:")


def test_numbers_at_the_head_lead_to_what_derives_them(page):
    text = page("proved")
    titles = dict(
        re.findall(
            r'<section id="(section-\d+)"[^>]*>\s*(?:<details><summary>)?<h2>([^<]+)</h2>', text
        )
    )
    head = text[: text.index('id="section-1"')]
    links = {
        label: titles[at]
        for at, label in re.findall(r'<a href="#(section-\d+)" title[^>]*>([^<]+)</a>', head)
    }
    assert links["3.916015625 1/s"] == "Lyapunov evidence"
    assert links["4 modes of 4 states, in continuous time"] == "Modes"
    assert {"Rungs tried", "How to check again", "The spec"} <= set(links.values())


def test_what_is_named_in_a_figure_can_be_pointed_at(page):
    titles = re.findall(r'data-named=""><title>([^<]+)</title>', page("proved"))
    assert {"insertion/soft/k-min", "withdrawal/free", "limit of the spec"} <= set(titles)


def test_hostile_title_is_escaped(page):
    text = page("discrete")
    assert "&lt;script&gt;alert(1)&lt;/script&gt; &amp; &#34;it&#39;s&#34; {{ 7*7 }}" in text


def test_only_a_short_last_column_stays_in_one_line(report):
    """A last column of sentences must wrap, or the edge of the page cuts it off."""
    long = "words that would not fit beside the others in one line of a page " * 2
    tables = tuple(Table("", ("a", "b"), ((long, last),)) for last in ("not met", long))
    shown = render_html(replace(report("proved"), sections=(Section("Tables", tables),)))
    assert re.findall(r'<table class="([a-z ]+)"', shown) == ["wide prose brief", "wide prose"]
