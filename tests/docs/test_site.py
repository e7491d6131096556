"""The pages as a whole: four kinds of them, a glossary, decisions."""

import re

import pytest
from ruamel.yaml import YAML

from nrs_design.proof.evidence import KINDS
from tests.docs.pages import kind_pages, pages, text_of
from tests.support import ROOT

NAV = YAML(typ="safe").load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"]


def pages_in(nav):
    for entry in nav:
        for held in entry.values():
            yield from pages_in(held) if isinstance(held, list) else [held]


def test_navigation_has_four_kinds_and_names_no_page_twice():
    kinds = ["Home", "Tutorial", "How-to", "Reference", "Explanation"]
    assert [next(iter(entry)) for entry in NAV] == kinds
    named = list(pages_in(NAV))
    assert len(named) == len(set(named)) > 50


def words_of(text):
    """Words have a letter or a digit: signs of tables are none."""
    return sum(bool(re.search(r"\w", word)) for word in text.split())


def test_pages_are_short_one_by_one_and_together():
    lengths = {page: words_of(text_of(page)) for page in [*pages(), "CHANGELOG.md"]}
    # A changelog says what went, and what to do instead.
    most = dict.fromkeys(lengths.keys() - {"README.md"}, 900) | {"CHANGELOG.md": 1_200}
    assert {page: lengths[page] for page, n in most.items() if lengths[page] > n} == {}
    assert sum(lengths.values()) <= 24_200


def test_no_heading_begins_with_a_digit():
    """The theme looks headings up by their ids, and an id of CSS begins with a letter."""
    headings = [line for page in pages() for line in re.findall(r"^#+ \d.*", text_of(page), re.M)]
    assert headings == []


# mkdocs checks the links between the pages of docs/.
BESIDE = ("README.md", "CONTRIBUTING.md", "SECURITY.md", "CHANGELOG.md", "benchmarks/README.md")


def anchors_of(page):
    headings = re.findall(r"^#+ (.*)", text_of(page), re.MULTILINE)
    return {re.sub(r"[^\w\s-]", "", line).strip().lower().replace(" ", "-") for line in headings}


@pytest.mark.parametrize("page", BESIDE)
def test_links_beside_the_pages_lead_somewhere(page):
    for link in re.findall(r"\]\((?!https?:)([^)\s]+)\)", text_of(page)):
        name, _, anchor = link.partition("#")
        target = (ROOT / page).parent / name if name else ROOT / page
        assert target.exists(), link
        assert not anchor or anchor in anchors_of(target.resolve().relative_to(ROOT).as_posix())


def test_every_kind_of_evidence_has_its_heading_and_its_row():
    rows = kind_pages()
    assert sorted(rows) == sorted(KINDS)
    assert {page.removeprefix("docs/") for page in rows.values()} <= set(pages_in(NAV))
    for kind, page in rows.items():
        assert re.search(rf"^##? `{kind}`", text_of(page), re.MULTILINE)


def test_decisions_are_questions_with_an_answer():
    assert "(decisions.md)" in text_of("docs/architecture.md")
    entries = text_of("docs/decisions.md").split("\n\n")[1:]
    assert len(entries) == 6
    assert [entry for entry in entries if not re.match(r"\*\*[^*]+\?\*\* \w", entry)] == []


def test_the_glossary_is_in_order_and_explains():
    text = text_of("docs/explanation/glossary.md")
    for section in text.split("\n## ")[1:]:
        terms = re.findall(r"^\*\*(.+?)\*\*.*\n:   (.+)", section, re.MULTILINE)
        assert len(terms) == len(re.findall(r"^\*\*", section, re.MULTILINE))
        names = [name.lower().replace(",", "") for name, _ in terms]
        assert names == sorted(names)
        assert len(terms) > 7
