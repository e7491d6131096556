"""The pages that `nox -s docs` built in site/, opened from that folder as a reader does."""

import time

import pytest

from tests.browser import faults_of, open_file, overflow_of, severe
from tests.support import ROOT
from tests.tables import entry

SITE = ROOT / "site"
LOOKED_AT = entry(__file__, "LOOKED_AT")

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def site(axe):
    """Only `nox -s accessibility` asks for it; CI builds it before."""
    assert SITE.is_dir(), "nox -s docs builds site/ first"
    return SITE


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("page", LOOKED_AT)
def test_accessibility_and_width(site, axe, browser, page, scheme):
    for width in (390, 1280, 1920):
        open_file(browser, site / page, width, scheme)
        assert overflow_of(browser) == 0
        assert severe(browser) == []
    assert faults_of(browser, axe) == []


def found(browser, words):
    browser.execute_script(
        "const field = document.getElementById('mkdocs-search-query'); field.value = arguments[0];"
        "document.getElementById('mkdocs-search-results').replaceChildren();"
        "field.dispatchEvent(new Event('input'));",
        words,
    )
    listed = "return [...document.querySelectorAll('#mkdocs-search-results a')].map(a => a.href)"
    shown = "return document.getElementById('mkdocs-search-results').textContent"
    end = time.monotonic() + 20
    while not browser.execute_script(shown) and time.monotonic() < end:
        time.sleep(0.02)
    return [address.partition("/site/")[2] for address in browser.execute_script(listed)]


def test_search_finds_what_is_there_accessibility(site, browser):
    open_file(browser, site / "design" / "sampling.html", 1280)
    assert any(page.startswith("explanation/glossary.html") for page in found(browser, "glossary"))
    # The beginning of a word is enough, all words must be there, and signs part words.
    assert any(page.startswith("reference/spec.html") for page in found(browser, "decay_ra"))
    assert found(browser, "glossary zzyzx") == []
    assert severe(browser) == []
