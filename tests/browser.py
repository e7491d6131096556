"""Headless Chromium: pages as a reader sees them, and the rules of axe-core."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support import program_named


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Headless Chromium; without it the tests are skipped, except in CI."""
    chromium, driver = map(program_named, ("chromium", "chromedriver"))
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    window = webdriver.Chrome(options=options, service=webdriver.ChromeService(driver))
    yield window
    window.quit()


@pytest.fixture(scope="module")
def axe() -> str:
    """The rules of axe-core, whose file AXE names; `nox -s accessibility` brings it along.

    Tests ask for them first: without them, no browser is started.
    """
    path = os.environ.get("AXE")
    if path is None:
        pytest.skip("AXE does not name axe.min.js")
    return Path(path).read_text(encoding="utf-8")


def open_file(browser: Any, path: Path, width: int, scheme: str = "light") -> None:
    """Open a page from its folder, on a screen of a width in px."""
    browser.execute_cdp_cmd(
        "Emulation.setDeviceMetricsOverride",
        {"width": width, "height": 900, "deviceScaleFactor": 1, "mobile": False},
    )
    preference = {"name": "prefers-color-scheme", "value": scheme}
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [preference]})
    browser.get_log("browser")  # Of the page before.
    browser.get(path.as_uri())


def overflow_of(browser: Any) -> int:
    """How many px of the open page are cut at its right."""
    script = "const e = document.documentElement; return e.scrollWidth - e.clientWidth"
    return int(browser.execute_script(script))


def severe(browser: Any) -> list[Any]:
    """What scripts of the page complain of."""
    return [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]


def faults_of(browser: Any, axe: str) -> list[Any]:
    browser.execute_script(axe)
    found = browser.execute_async_script(
        "axe.run().then(r => arguments[0](r.violations.map("
        "v => [v.impact, v.id, v.nodes.map(n => n.target + ': ' + n.failureSummary)])))"
    )
    return [fault for fault in found if fault[0] in ("serious", "critical")]
