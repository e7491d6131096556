from __future__ import annotations

import io
from collections import Counter
from dataclasses import replace
from datetime import date

import pytest
from pypdf import PdfReader

from nrs_design.reporting import Report, render_pdf
from nrs_design.reporting.document import Bullets, Illustration, Section, Table
from tests.reporting.conftest import HOSTILE

NAMES = (
    r"""a$\frac{$ <b>&amp; "q" #panic() *x* _y_ `z` [w] @l \ // שלום 中 \u202e """
    + "\u202e\n\x1b\udcff"
)


def reader_of(report):
    return PdfReader(io.BytesIO(render_pdf(report)))


def text_of(reader):
    return " ".join(" ".join(page.extract_text() for page in reader.pages).split())


def elements(reader):
    """All structure elements in reading order."""
    found = []

    def visit(node):
        node = node.get_object()
        if isinstance(node, list):
            for child in node:
                visit(child)
        elif isinstance(node, dict):
            if "/S" in node:
                found.append(node)
            if "/K" in node:
                visit(node["/K"])

    visit(reader.root_object["/StructTreeRoot"])
    return found


@pytest.mark.parametrize(
    "case",
    ["dwell", *(pytest.param(c, marks=pytest.mark.slow) for c in ("refuted", "inconclusive"))],
)
def test_pdf_has_the_text_of_the_verdict(report, case):
    text = text_of(reader_of(report(case)))
    assert report(case).verdict.upper() in text
    squeezed = text.replace(" ", "")
    for said in (report(case).claim, *report(case).remarks):
        assert "".join(said.split()) in squeezed


@pytest.mark.slow
def test_hostile_title_is_plain_text(report):
    assert report("discrete").title in text_of(reader_of(report("discrete")))


@pytest.mark.slow
def test_every_part_is_tagged(report):
    case = report("proved")
    reader = reader_of(case)
    assert reader.root_object["/MarkInfo"]["/Marked"]
    assert reader.root_object["/Lang"] == "en"
    assert "pdfuaid" in reader.xmp_metadata.stream.get_data().decode()
    tags = Counter(element["/S"] for element in elements(reader))
    drawn = list(case.illustrations)
    blocks = [block for section in case.sections for block in section.blocks]
    titled = [b for b in blocks if isinstance(b, Bullets | Illustration) and b.title]
    assert tags["/H1"] == len(case.sections)
    assert tags["/H2"] == len(titled)
    assert tags["/Table"] == tags["/Caption"] == sum(isinstance(b, Table) for b in blocks)
    assert tags["/TH"] == sum(len(b.columns) for b in blocks if isinstance(b, Table))
    figures = [element for element in elements(reader) if element["/S"] == "/Figure"]
    assert [figure["/Alt"] for figure in figures] == [item.caption for item in drawn]


def test_bookmarks_are_the_sections_and_what_they_hold(report):
    case = report("refuted")
    outline = reader_of(case).outline
    assert [item.title for item in outline if not isinstance(item, list)] == [
        section.title for section in case.sections
    ]
    inner = [item.title for part in outline if isinstance(part, list) for item in part]
    assert {item.title for item in case.illustrations} <= set(inner)


def test_same_report_gives_the_same_bytes_in_any_environment(report, monkeypatch):
    first = render_pdf(report("refuted"))
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    assert render_pdf(report("refuted")) == first
    metadata = PdfReader(io.BytesIO(first)).metadata
    assert metadata.creation_date is None
    (sha256,) = (value for label, value in report("refuted").facts if label.startswith("SHA-256"))
    assert metadata["/Keywords"] == f"nrs-design, sha256:{sha256}"


def test_a_given_date_is_on_the_page_and_in_the_file(report):
    reader = reader_of(replace(report("refuted"), date=date(2026, 3, 1)))
    assert reader.metadata.creation_date.date() == date(2026, 3, 1)
    assert "Date 2026-03-01" in text_of(reader)


@pytest.mark.parametrize("name", [HOSTILE, NAMES])
def test_names_are_text_wherever_they_stand(name):
    report = Report(
        name=name,
        title=name,
        verdict="refuted",
        claim=name,
        remarks=(name,),
        facts=((name, name),),
        sections=(
            Section(name, (Bullets(name, (name,)), Table(name, (name, "b"), ((name, name),)))),
        ),
        footer=name,
    )
    text = text_of(reader_of(report))
    assert text.count("{{ 7*7 }}" if name == HOSTILE else "#panic()") >= 9
    assert "\u202e" not in text


def test_an_empty_report_can_be_set():
    report = Report("n", "", "inconclusive", "c", (), (), (Section("s", (Bullets("", ("b",)),)),))
    assert "INCONCLUSIVE" in text_of(reader_of(report))
