"""The drawing: well formed, the same each time, and in a browser every text inside its shape."""

from xml.etree import ElementTree

import pytest

from nrs_design.assurance.gsn import GsnElement, GsnKind, goal, solution
from nrs_design.assurance.gsn_svg import render_svg

SVG = "{http://www.w3.org/2000/svg}"
WORDS = "a text that goes on for longer than one line of its shape, by far " * 3


def example():
    leaves = [goal(f"G{k}", WORDS, solution(f"Sn{k}", WORDS)) for k in (4, 5)]
    hidden = '<script>alert("&")</script>\u202e'
    hanging = GsnElement("S2", GsnKind.STRATEGY, "by parts", (*leaves, goal("G6", hidden)))
    context = tuple(GsnElement(f"{k[0]}1", k, WORDS) for k in (GsnKind.CONTEXT, GsnKind.ASSUMPTION))
    parts = (goal("G2", "x", hanging, refuted=True), goal("G3", "Mt " * 70, goal("G7", "0" * 200)))
    strategy = GsnElement("S1", GsnKind.STRATEGY, "over both", parts)
    return GsnElement("G1", GsnKind.GOAL, "all", (strategy,), context)


def test_every_element_is_drawn_once_with_its_whole_text():
    root = ElementTree.fromstring(render_svg(example()))
    drawn = {g.get("id"): g.find(f"{SVG}title").text for g in root.iter(f"{SVG}g") if g.get("id")}
    elements = [*example().walk()]
    assert drawn.keys() == {element.id for element in elements}
    assert drawn["G4"] == WORDS
    assert not [*root.iter(f"{SVG}script")]
    assert "\u202e" not in render_svg(example())
    diamonds = [p for p in root.iter(f"{SVG}polygon") if p.get("class") == "undeveloped"]
    assert len(diamonds) == sum(element.undeveloped for element in elements)


def test_what_is_refuted_is_marked():
    assert render_svg(example()).count('class="refuted"') == 1


def test_the_same_argument_gives_the_same_text():
    assert render_svg(example()) == render_svg(example())


@pytest.mark.browser
@pytest.mark.slow
def test_in_a_browser_texts_fit_and_shapes_do_not_overlap(browser, tmp_path, sampled_folder):
    (tmp_path / "example.svg").write_text(render_svg(example()))
    for file in (tmp_path / "example.svg", sampled_folder / "argument.svg"):
        browser.get(file.as_uri())
        wide, shapes = browser.execute_script(
            "const box = e => { const r = e.getBoundingClientRect();"
            " return [r.left, r.top, r.right, r.bottom]; };"
            "return [[...document.querySelectorAll('g[id]')].flatMap(g => {"
            " const s = g.querySelector('rect,ellipse,circle,polygon');"
            " const [l, t, r, b] = box(s);"
            " return [...g.querySelectorAll('text')]"
            "  .filter(e => !/^[AJ]$/.test(e.textContent))"
            "  .filter(e => { const [x, y, u, v] = box(e);"
            "   return x < l || u > r || y < t - 1 || v > b + 1; })"
            "  .map(e => e.textContent); }),"
            " [...document.querySelectorAll('g[id]')].map(g =>"
            "  [g.id, box(g.querySelector('rect,ellipse,circle,polygon'))])]"
        )
        assert wide == []
        assert [pair for pair in pairs_of(shapes) if overlap(*pair)] == []


def pairs_of(shapes):
    return [(a, b) for k, a in enumerate(shapes) for b in shapes[k + 1 :]]


def overlap(one, other):
    (_, (l1, t1, r1, b1)), (_, (l2, t2, r2, b2)) = one, other
    return min(r1, r2) - max(l1, l2) > 0.5 and min(b1, b2) - max(t1, t2) > 0.5
