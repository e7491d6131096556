from __future__ import annotations

import io

import pytest
from pypdf import PdfReader

from nrs_design.reporting import render_pdf


@pytest.mark.parametrize("case", ["refuted", "inconclusive", "dwell", "blocks"])
def test_pdf_has_the_text_of_the_verdict(report, case):
    reader = PdfReader(io.BytesIO(render_pdf(report(case))))
    text = "\n".join(page.extract_text() for page in reader.pages)
    assert report(case).verdict.upper() in text
    assert " ".join(report(case).claim.split()) in " ".join(text.split())
    for remark in report(case).remarks:
        assert " ".join(remark.split()) in " ".join(text.split())
    images = sum(len(page.images) for page in reader.pages)
    assert images == len(list(report(case).illustrations))


def test_hostile_title_is_plain_text(report):
    reader = PdfReader(io.BytesIO(render_pdf(report("discrete"))))
    assert report("discrete").title in " ".join(reader.pages[0].extract_text().split())


def test_same_report_gives_the_same_bytes(report):
    assert render_pdf(report("refuted")) == render_pdf(report("refuted"))
