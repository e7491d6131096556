import base64
import hashlib
import html
import json
import re
from fractions import Fraction

import pytest

from nrs_design.certificates.certificate import canonical
from nrs_design.thesis.table import render_page, reproduce
from tests.browser import faults_of, open_file, overflow_of, severe
from tests.certificates.attacks import (
    ATTACKS,
    BOTH,
    CONSTANT,
    DEAR_ATTACKS,
    PAGE_ALONE,
    SHIPPED,
    found,
    named,
    shipped,
)
from tests.reporting.conftest import KINDS, slow

CASES = ["proved", "dwell"]
MORE = [slow(name) for name in ("force", "refuted", "discrete")]
ALL = [
    *CASES,
    *MORE,
    *(pytest.param(k, marks=pytest.mark.nightly) for k in KINDS if k not in CASES),
]

pytestmark = pytest.mark.browser


def open_page(browser, text, folder, width, scheme="light"):
    path = folder / "report.html"
    path.write_text(text, encoding="utf-8")
    open_file(browser, path, width, scheme)


def unfold(browser):
    script = "document.querySelectorAll('details').forEach(fold => { fold.open = true; })"
    browser.execute_script(script)


@pytest.mark.parametrize("width", [375, 1280])
@pytest.mark.parametrize("case", ALL)
def test_page_renders(browser, report, page, tmp_path, case, width):
    open_page(browser, page(case), tmp_path, width)
    unfold(browser)
    assert severe(browser) == []
    sizes = browser.execute_script(
        "return [...document.querySelectorAll('figure svg')].map(s => {"
        "const r = s.getBoundingClientRect(); return [r.width, r.height, s.getBBox().width]})"
    )
    assert len(sizes) == len(list(report(case).illustrations))
    assert all(w > 250 and h > 60 and inner > 0 for w, h, inner in sizes)
    assert overflow_of(browser) == 0


@pytest.mark.parametrize("case", ALL)
def test_a_telephone_shows_all_of_it_legibly(browser, page, tmp_path, case):
    """Letters of figures are 8 px high or more; no table hides a column to the right."""
    open_page(browser, page(case), tmp_path, 390)
    unfold(browser)
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


@pytest.mark.parametrize("case", ALL)
def test_letters_within_a_figure_do_not_overlap(browser, page, tmp_path, case):
    """Text groups of one figure may touch a curve, but not each other."""
    open_page(browser, page(case), tmp_path, 1280)
    unfold(browser)
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


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_follows_the_reader_and_can_be_turned(browser, page, tmp_path, scheme):
    open_page(browser, page("dwell"), tmp_path, 800, scheme)
    color = "return getComputedStyle(document.documentElement).backgroundColor"
    before = browser.execute_script(color)
    assert before == ("rgb(255, 255, 255)" if scheme == "light" else "rgb(20, 24, 29)")
    button = browser.find_element("css selector", ".theme")
    button.click()
    assert browser.execute_script(color) != before
    button.click()
    assert browser.execute_script(color) == before


def test_a_figure_names_what_is_pointed_at_and_can_be_enlarged(browser, page, tmp_path):
    from selenium.webdriver import ActionChains

    open_page(browser, page("dwell"), tmp_path, 800)
    curve = browser.find_element("css selector", "#run [data-named] path")
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", curve)
    # The middle of a stroke, as pixels from the middle of the figure.
    x, y = browser.execute_script(
        """
        const [path, svg] = [arguments[0], arguments[0].ownerSVGElement];
        const at = path.getPointAtLength(path.getTotalLength() / 2);
        const p = new DOMPoint(at.x, at.y).matrixTransform(path.getScreenCTM());
        const r = svg.getBoundingClientRect();
        return [p.x - r.left - r.width / 2, p.y - r.top - r.height / 2];
        """,
        curve,
    )
    svg = browser.find_element("css selector", "#run svg")
    ActionChains(browser).move_to_element_with_offset(svg, round(x), round(y)).perform()
    told = browser.find_element("css selector", "#run output").text
    assert told.startswith("run (")
    box = "return document.querySelector('#run svg').viewBox.baseVal.width"
    whole = browser.execute_script(box)
    closer, _, everything = browser.find_elements("css selector", "#run button")
    closer.click()
    assert browser.execute_script(box) == pytest.approx(whole / 2)
    everything.click()
    assert browser.execute_script(box) == pytest.approx(whole)


@pytest.mark.parametrize("case", ["proved", "refuted", "inconclusive"])
def test_the_first_screen_says_it_and_the_rest_is_folded(browser, page, tmp_path, case):
    """Verdict, key facts and the run at 1280 x 800; at most 1,200 words and 40 links unfolded."""
    open_page(browser, page(case), tmp_path, 1280)
    low, words, links = browser.execute_script(
        "const low = s => document.querySelector(s).getBoundingClientRect().bottom;"
        "return [Math.max(low('.badge'), low('.key'), low('header figure svg')),"
        "document.body.innerText.split(/\\s+/).length,"
        "[...document.querySelectorAll('a')].filter(a => a.checkVisibility()).length]"
    )
    assert low <= 800
    assert words <= 1200
    assert links <= 40


def test_a_link_opens_what_it_leads_to(browser, page, tmp_path):
    open_page(browser, page("proved"), tmp_path, 1280)
    shown = "return document.querySelector('.claim').checkVisibility()"
    assert not browser.execute_script(shown)
    browser.execute_script("location.hash = '#statement'")
    assert browser.execute_async_script(
        "setTimeout(() => arguments[0](document.querySelector('.claim').checkVisibility()), 100)"
    )


def test_without_its_script_the_page_says_all_the_same(browser, page, tmp_path):
    text = "return document.body.innerText"
    open_page(browser, page("dwell"), tmp_path, 800)
    added = "document.querySelectorAll('button, .tools')"
    assert browser.execute_script(f"return {added}.length") > 0
    browser.execute_script(f"{added}.forEach(b => b.remove())")
    scripted = browser.execute_script(text)
    browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
    try:
        open_page(browser, page("dwell"), tmp_path, 800)
        assert browser.execute_script(text) == scripted
        assert not browser.find_elements("css selector", "button")
    finally:
        browser.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})


def pressed(browser, text, folder):
    """Press the button of a page, and return what it says: good, bad or unknown, in words."""
    open_page(browser, text, folder, 800)
    browser.find_element("css selector", "#check button").click()
    from selenium.webdriver.support.ui import WebDriverWait

    told = browser.find_element("css selector", "#check output")
    WebDriverWait(browser, 60).until(lambda _: told.get_attribute("class"))
    assert severe(browser) == []
    return told.get_attribute("class"), told.text


@pytest.mark.parametrize("case", ["proved", "dwell", slow("polynomial")])
def test_the_page_checks_its_proof(browser, page, tmp_path, case):
    state, words = pressed(browser, page(case), tmp_path)
    assert state == "good"
    assert re.match(r"Holds for the \d+ modes.* in this page, checked in [\d.]+ s: decay", words)
    assert "Not checked: whose modes these are" in words
    assert "Who changed a page could change this check, too." in words


@pytest.mark.parametrize("case", ["refuted", slow("period")])
def test_the_page_says_what_it_cannot_check(browser, page, tmp_path, case):
    state, words = pressed(browser, page(case), tmp_path)
    assert state == "unknown"
    assert "Not checked here: growing-sequence (this kind)." in words
    assert "decay" not in words


def test_without_a_certificate_there_is_nothing_to_check(page):
    assert '<pre id="numbers"' in page("dwell")
    assert "<pre" not in page("inconclusive-leaving")
    assert "Bareiss" not in page("inconclusive-leaving")


def renamed(text):
    numbers = html.unescape(re.search(r'<pre id="numbers" hidden>(.*)</pre>', text)[1])
    identity = hashlib.sha256(numbers.encode()).hexdigest()
    return re.sub(r"(Certificate id</dt><dd><a [^>]*>)[0-9a-f]{64}", rf"\g<1>{identity}", text)


def in_numbers(pattern, replacement):
    def changed(text):
        head, rest = text.split('<pre id="numbers" hidden>')
        numbers, tail = rest.split("</pre>", 1)
        return f'{head}<pre id="numbers" hidden>{re.sub(pattern, replacement, numbers)}</pre>{tail}'

    return changed


RATE, FORM = r'"rate":"[^"]+"', r'"form":\[\[(\d+)'
TAMPERED = {
    "rate": (in_numbers(RATE, '"rate":"5"'), "the numbers are not those"),
    "rate and id": (lambda t: renamed(in_numbers(RATE, '"rate":"5"')(t)), "graph (it rises in"),
    "form and id": (lambda t: renamed(in_numbers(FORM, r'"form":[[-\1')(t)), "graph (a form at"),
    "badge": (lambda t: t.replace('badge">proved', 'badge">refuted'), "the verdict of the page"),
    "float": (
        lambda t: renamed(in_numbers(r'"denominator_log2":(\d+)', r'"denominator_log2":\1.5')(t)),
        "Cannot convert",
    ),
}


@pytest.mark.parametrize("name", TAMPERED)
def test_a_tampered_page_is_refused(browser, page, tmp_path, name):
    tamper, why = TAMPERED[name]
    tampered = tamper(page("proved"))
    assert tampered != page("proved")
    state, words = pressed(browser, tampered, tmp_path)
    assert (state, words[:8]) == ("bad", "Refused:")
    assert why in words


@pytest.fixture
def decide(browser, page, tmp_path):
    """Let the script of a page decide about certificates: all hold, one does not, or neither."""
    open_page(browser, page("proved"), tmp_path, 800)

    def decided(document):
        results, agrees = browser.execute_script(
            "try { const { results, agrees } = check(arguments[0]);"
            "return [results.map(([holds]) => holds), agrees]; }"
            "catch (error) { return [[false], false]; }",
            canonical(document),
        )
        if all(results):
            return agrees
        return False if False in results else None

    return decided


@pytest.mark.slow
def test_the_page_agrees_on_what_ships(decide):
    wrong = [path.name for path in SHIPPED if not decide(json.loads(path.read_text()))]
    assert wrong == [f"{CONSTANT}.cert.json"]


@pytest.mark.slow
@pytest.mark.parametrize("example", [*BOTH, *PAGE_ALONE])
def test_the_page_agrees_on_shapes_that_do_not_ship(decide, example):
    document = found(example)
    assert decide(document)
    statement = document["statements"][0]
    faster = Fraction(1, 2) if document["time"] == "discrete" else 100
    if statement["kind"] == "graph":
        statement["rate"] = str(Fraction(statement["rate"]) * faster)
    else:
        statement["factors"].pop()
    assert decide(document) is False


def test_the_page_refuses_forgeries(decide):
    for name, change in ATTACKS:
        forged = shipped(name)
        change(forged)
        assert not decide(forged), (name, change.__name__)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "change"), DEAR_ATTACKS, ids=named)
def test_the_page_refuses_forgeries_of_sampled_loops(decide, name, change):
    forged = shipped(name)
    change(forged)
    assert not decide(forged)


@pytest.mark.slow
def test_printed_pages_are_light_and_numbered(browser, page, tmp_path):
    """A dark screen must not make dark paper."""
    open_page(browser, page("dwell"), tmp_path, 800, "dark")
    printed = browser.execute_cdp_cmd("Page.printToPDF", {"generateTaggedPDF": True})
    pdf = base64.b64decode(printed["data"])
    assert pdf.count(b"/Type /Page\n") > 1
    assert b"/Marked true" in pdf
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    paper = "return getComputedStyle(document.documentElement).backgroundColor"
    shown = browser.execute_script(paper)
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
    assert shown == "rgb(255, 255, 255)"
    assert 'content: counter(page) " / " counter(pages)' in page("dwell")


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("case", ["proved", "refuted", "inconclusive", "dwell", "discrete"])
def test_no_serious_fault_of_accessibility(axe, browser, page, tmp_path, case, scheme):
    open_page(browser, page(case), tmp_path, 1280, scheme)
    assert faults_of(browser, axe) == []


@pytest.fixture(scope="module")
def reproduced(axe):
    return render_page(reproduce())


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_no_serious_fault_of_accessibility_in_reproduced(
    axe, browser, reproduced, tmp_path, scheme
):
    open_page(browser, reproduced, tmp_path, 1280, scheme)
    assert faults_of(browser, axe) == []
