"""The pages as a whole: four kinds of them, a glossary, records of decisions."""

import re

from ruamel.yaml import YAML

from nrs_design.proof.evidence import KINDS
from tests.docs.pages import DOCS, text_of
from tests.support import ROOT

NAV = YAML(typ="safe").load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))["nav"]


def pages_in(nav):
    for entry in nav:
        for held in entry.values():
            yield from pages_in(held) if isinstance(held, list) else [held]


def test_navigation_has_four_kinds():
    assert [next(iter(entry)) for entry in NAV] == [
        "Home",
        "Tutorial",
        "How-to",
        "Reference",
        "Explanation",
    ]


def test_no_page_is_named_twice():
    named = list(pages_in(NAV))
    assert len(named) == len(set(named)) > 60


def test_every_kind_of_evidence_has_its_page_and_its_row():
    rows = re.findall(
        r"^\| `([\w-]+)` \| .* \| \[", text_of("docs/certificates/README.md"), re.MULTILINE
    )
    assert sorted(rows) == sorted(KINDS)
    assert {f"certificates/{kind}.md" for kind in KINDS} <= set(pages_in(NAV))
    assert [kind for kind in KINDS if not (DOCS / f"certificates/{kind}.md").is_file()] == []


def test_records_of_decisions_are_short_and_whole():
    records = sorted((DOCS / "decisions").glob("0*.md"))
    listed = re.findall(r"\[(\d{4})\]\((\S+)\)", text_of("docs/decisions/README.md"))
    assert [name for _, name in listed] == [path.name for path in records]
    for number, path in enumerate(records, 1):
        text = path.read_text(encoding="utf-8")
        assert path.name.startswith(f"{number:04}-")
        assert text.startswith(f"# Decision {number}: ")
        marks = re.findall(r"^\*\*(\w+)\.\*\*", text, re.MULTILINE)
        assert marks == ["Context", "Decision", "Consequences"]
        assert len(text.splitlines()) <= 20


def test_the_glossary_is_in_order_and_explains():
    text = text_of("docs/explanation/glossary.md")
    for section in text.split("\n## ")[1:]:
        terms = re.findall(r"^\*\*(.+?)\*\*.*\n:   (.+)", section, re.MULTILINE)
        assert len(terms) == len(re.findall(r"^\*\*", section, re.MULTILINE))
        names = [name.lower().replace(",", "") for name, _ in terms]
        assert names == sorted(names)
        assert len(terms) > 15


def test_decisions_that_a_table_gives_in_short_are_linked():
    assert "decisions/README.md" in text_of("docs/architecture.md")
