from __future__ import annotations

import os
import shutil
from itertools import pairwise

import pytest

from tests.reporting.conftest import KINDS

CASES = ["proved", "dwell", "blocks"]
MORE = ["force", "refuted", "discrete", *(name for name in KINDS if name not in CASES)]
ALL = [*CASES, *(pytest.param(name, marks=pytest.mark.slow) for name in MORE)]

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def browser():
    """Headless Chromium; without it the tests are skipped, except in CI."""
    chromium, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if chromium is None or driver is None:
        message = "chromium or chromedriver is not installed"
        if os.environ.get("CI") == "true":
            pytest.fail(f"{message}, and CI must have it")
        pytest.skip(message)
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    window = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    yield window
    window.quit()


def open_page(browser, html, folder, width):
    path = folder / "report.html"
    path.write_text(html, encoding="utf-8")
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False},
    )
    browser.get(path.as_uri())


@pytest.mark.parametrize("width", [375, 1280])
@pytest.mark.parametrize("case", ALL)
def test_page_renders(browser, report, page, tmp_path, case, width):
    open_page(browser, page(case), tmp_path, width)
    assert [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"] == []
    sizes = browser.execute_script(
        "return [...document.querySelectorAll('figure svg')].map(s => {"
        "const r = s.getBoundingClientRect(); return [r.width, r.height, s.getBBox().width]})"
    )
    assert len(sizes) == len(list(report(case).illustrations))
    assert all(w > 250 and h > 60 and inner > 0 for w, h, inner in sizes)
    overflow = "return document.documentElement.scrollWidth - document.documentElement.clientWidth"
    assert browser.execute_script(overflow) == 0


@pytest.mark.parametrize("case", ALL)
def test_a_telephone_shows_all_of_it_legibly(browser, page, tmp_path, case):
    """Letters of figures are 8 px high or more; no table hides a column to the right."""
    open_page(browser, page(case), tmp_path, 390)
    scales = browser.execute_script(
        "return [...document.querySelectorAll('figure svg')].map(s => "
        "s.getBoundingClientRect().width / s.viewBox.baseVal.width)"
    )
    # Figures are in points, and their smallest letters have 9.
    assert min(scales) * 9 >= 8
    hidden = browser.execute_script(
        "return [...document.querySelectorAll('.table')]"
        ".filter(t => t.scrollWidth > t.clientWidth + 1).map(t => t.ariaLabel)"
    )
    assert hidden == []


@pytest.mark.parametrize("width", [375, 1280])
def test_blocks_do_not_overlap(browser, page, tmp_path, width):
    open_page(browser, page("proved"), tmp_path, width)
    boxes = browser.execute_script(
        "return [...document.querySelectorAll("
        "'header > *, section > *:not(figure), figure > *')].map(e => {"
        "const r = e.getBoundingClientRect(); return [r.top, r.bottom, e.tagName]})"
    )
    boxes = [box for box in boxes if box[1] > box[0]]
    assert len(boxes) > 30
    overlaps = [(a, b) for a, b in pairwise(boxes) if b[0] < a[1] - 1]
    assert overlaps == []


@pytest.mark.parametrize("case", ALL)
def test_letters_within_a_figure_do_not_overlap(browser, page, tmp_path, case):
    """Text groups of one figure may touch a curve, but not each other."""
    open_page(browser, page(case), tmp_path, 1280)
    overlaps = browser.execute_script(
        """
        const found = [];
        for (const figure of document.querySelectorAll('figure')) {
          const texts = [...figure.querySelectorAll('svg g[id*="-text_"]')]
            .map(t => [t.id, t.getBoundingClientRect()]).filter(t => t[1].width > 0);
          for (let i = 0; i < texts.length; i++) for (let j = 0; j < i; j++) {
            const [a, b] = [texts[i][1], texts[j][1]];
            const x = Math.min(a.right, b.right) - Math.max(a.left, b.left);
            const y = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
            if (x > 1 && y > 1) found.push([texts[i][0], texts[j][0]]);
          }
        }
        return found;
        """
    )
    assert overlaps == []
