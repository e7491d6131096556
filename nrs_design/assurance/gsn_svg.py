"""An argument as a drawing: goals above what supports them, solutions beside their goals.

By hand, and not by matplotlib: the same argument gives the same lines of text, so that a change
shows as one in a diff, and texts stay texts.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from html import escape
from math import hypot

from nrs_design.assurance.gsn import MAY_SUPPORT, GsnElement, GsnKind
from nrs_design.output import SVG_MARK
from nrs_design.printable import visible

# In px: a line of text, a digit in the widest of common fonts, and between things.
LINE, LETTER, GAP, MARGIN = 14, 7.1, 26, 10
DIAMOND = 7
# Letters in a line, and lines; the whole text is in the title of an element and in the outline.
ROOM = {
    GsnKind.GOAL: (34, 6),
    GsnKind.STRATEGY: (34, 4),
    GsnKind.SOLUTION: (15, 6),
    GsnKind.CONTEXT: (52, 14),
    GsnKind.ASSUMPTION: (26, 5),
    GsnKind.JUSTIFICATION: (26, 5),
}
_STYLE = (
    "text{font:11px Arial,Helvetica,sans-serif;text-anchor:middle;fill:#111}"
    ".id{font-weight:bold}"
    "rect,ellipse,circle,polygon{fill:#fff;stroke:#111}"
    ".refuted{fill:#fdd;stroke:#b00020;stroke-width:2}"
    "path{fill:none;stroke:#111}"
    ".context{marker-end:url(#hollow)}"
    ".support{marker-end:url(#filled)}"
)
_MARKER = (
    '<marker id="{id}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="9" markerHeight="9" '
    'orient="auto"><path d="M1 1 L9 5 L1 9 Z" style="fill:{fill}"/></marker>'
)


@dataclass(frozen=True, slots=True)
class _Shape:
    """One element as it is drawn, its upper left corner at zero."""

    element: GsnElement
    lines: tuple[str, ...]
    width: float
    height: float


@dataclass(frozen=True, slots=True)
class _Drawing:
    """An element and all below it; whoever supports meets it at the top, at `x`."""

    parts: tuple[str, ...]
    width: float
    height: float
    x: float


def render_svg(top: GsnElement) -> str:
    """Return the drawing of an argument.

    Parameters
    ----------
    top : GsnElement
        The goal above all others.
    """
    drawn = _draw(top)
    width, height = drawn.width + 2 * MARGIN, drawn.height + 2 * MARGIN
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" '
        f'viewBox="0 0 {width:g} {height:g}" role="img">',
        f"<title>{_text(top.text)}</title>",
        f"<style>{_STYLE}</style>",
        f"<defs>{_MARKER.format(id='filled', fill='#111')}",
        f"{_MARKER.format(id='hollow', fill='#fff')}</defs>",
        f'<rect width="{width:g}" height="{height:g}" style="stroke:none"/>',
        *_moved(drawn.parts, MARGIN, MARGIN),
        "</svg>",
    ]
    head = f'<?xml version="1.0" encoding="utf-8" standalone="no"?>\n{SVG_MARK}'
    return head + "\n".join(lines) + "\n"


def _draw(element: GsnElement) -> _Drawing:
    """Draw an element, its context to the right, and what supports it below."""
    own = _with_context(element)
    if not element.supported_by:
        return own
    support = element.supported_by
    leaves = all(_is_leaf(child) for child in support)
    below = _hanging(support) if leaves else _beside(support)
    return _stacked(own, below, [] if leaves else _tops(below, support))


def _is_leaf(element: GsnElement) -> bool:
    """Tell whether there is nothing below an element but solutions."""
    return not element.in_context_of and all(
        child.kind is GsnKind.SOLUTION for child in element.supported_by
    )


def _with_context(element: GsnElement) -> _Drawing:
    shape = _shape(element)
    parts, y, width = [*_shown(shape)], 0.0, shape.width
    for context in element.in_context_of:
        aside = _shape(context)
        x = shape.width + 2 * GAP
        start = min(y + aside.height / 2, shape.height - 4)
        end = f"{x:g} {y + aside.height / 2:g}"
        parts.append(f'<path class="context" d="M{shape.width:g} {start:g} L{end}"/>')
        parts += _moved(tuple(_shown(aside)), x, y)
        y += aside.height + GAP / 2
        width = max(width, x + aside.width)
    height = max(shape.height + _below(element), y - GAP / 2 if y else 0.0)
    return _Drawing(tuple(parts), width, height, shape.width / 2)


def _hanging(children: tuple[GsnElement, ...]) -> _Drawing:
    """Draw leaves below each other, hanging on one line at their left; solutions beside them."""
    parts: list[str] = []
    y = width = 0.0
    for child in children:
        shape = _shape(child)
        row, aside = [*_moved(tuple(_shown(shape)), GAP, 0)], GAP + shape.width
        tall = shape.height + _below(child)
        for solved in child.supported_by:
            circle = _shape(solved)
            tall = max(tall, circle.height)
            start = f"{aside:g} {shape.height / 2:g}"
            row.append(f'<path class="support" d="M{start} h{GAP}"/>')
            up = shape.height / 2 - circle.height / 2
            row += _moved(tuple(_shown(circle)), aside + GAP, up)
            aside += GAP + circle.width
        # A circle that is taller than its goal stands out above it as much as below.
        over = max((_shape(s).height - shape.height for s in child.supported_by), default=0) / 2
        y += max(over, 0)
        parts += _moved(tuple(row), 0, y)
        parts.append(f'<path class="support" d="M0 {y + shape.height / 2:g} h{GAP}"/>')
        last = y + shape.height / 2
        y += max(tall - max(over, 0), shape.height) + GAP / 2
        width = max(width, aside)
    parts.append(f'<path d="M0 {-GAP:g} V{last:g}"/>')
    return _Drawing(tuple(parts), width, y - GAP / 2, 0.0)


def _beside(children: tuple[GsnElement, ...]) -> _Drawing:
    """Draw what supports an element side by side."""
    parts: list[str] = []
    x = height = 0.0
    for child in children:
        drawn = _draw(child)
        parts += _moved(drawn.parts, x, 0)
        x += drawn.width + GAP
        height = max(height, drawn.height)
    width = x - GAP
    return _Drawing(tuple(parts), width, height, width / 2)


def _tops(below: _Drawing, children: tuple[GsnElement, ...]) -> list[float]:
    """Return where arrows meet what stands side by side."""
    found, x = [], 0.0
    for child in children:
        drawn = _draw(child)
        found.append(x + drawn.x)
        x += drawn.width + GAP
    return found


def _stacked(own: _Drawing, below: _Drawing, tops: list[float]) -> _Drawing:
    """Draw an element above what supports it; without `tops`, what hangs below its left half.

    Lines begin behind the element, which is drawn over them.
    """
    bottom = own.height
    if not tops:
        # The line leaves the element at its bottom, a little left of its middle.
        shift = own.x - GAP * 2
        parts = (*own.parts, *_moved(below.parts, shift, bottom + GAP))
        line = f'<path d="M{shift:g} {LINE} V{bottom + GAP:g}"/>'
        width = max(own.width, shift + below.width)
        return _Drawing((line, *parts), width, bottom + GAP + below.height, own.x)
    middle = (tops[0] + tops[-1]) / 2
    left, right = max(0.0, own.x - middle), max(0.0, middle - own.x)
    x, down = right + own.x, bottom + 2 * GAP
    lines = [
        f'<path class="support" d="M{x:g} {LINE} V{bottom + GAP:g} H{left + top:g} V{down:g}"/>'
        for top in tops
    ]
    parts = (*lines, *_moved(own.parts, right, 0), *_moved(below.parts, left, down))
    width = max(right + own.width, left + below.width)
    return _Drawing(parts, width, down + below.height, x)


def _below(element: GsnElement) -> float:
    return 2 * DIAMOND if element.undeveloped else 0.0


def _shape(element: GsnElement) -> _Shape:
    letters, most = ROOM[element.kind]
    lines = textwrap.wrap(visible(element.text), letters)
    if len(lines) > most:
        lines = [*lines[: most - 1], lines[most - 1][: letters - 2] + " …"]
    lines = [element.id, *lines]
    wide, tall = max(map(len, lines)) * LETTER, len(lines) * LINE
    if element.kind is GsnKind.SOLUTION:
        across = hypot(wide, tall) + 4
        return _Shape(element, tuple(lines), across, across)
    if element.kind in MAY_SUPPORT:
        wide = letters * LETTER
    if element.kind in (GsnKind.ASSUMPTION, GsnKind.JUSTIFICATION):
        # The ellipse about a rectangle is wider and taller by the root of two.
        return _Shape(element, tuple(lines), wide * 1.42, tall * 1.42 + 6)
    return _Shape(element, tuple(lines), wide + 24, tall + 14)


def _shown(shape: _Shape) -> Iterator[str]:
    element, w, h = shape.element, shape.width, shape.height
    mark = ' class="refuted"' if element.refuted else ""
    yield f'<g id="{_text(element.id)}"><title>{_text(element.text)}</title>'
    yield _OUTLINES[element.kind].format(
        mark=mark, w=f"{w:g}", h=f"{h:g}", x=f"{w / 2:g}", y=f"{h / 2:g}", s=f"{w - 12:g}"
    )
    if element.undeveloped:
        x, d = w / 2, DIAMOND
        points = f"{x:g},{h:g} {x + d:g},{h + d:g} {x:g},{h + 2 * d:g} {x - d:g},{h + d:g}"
        yield f'<polygon class="undeveloped" points="{points}"/>'
    y = h / 2 - len(shape.lines) * LINE / 2 + LINE * 0.75
    for k, line in enumerate(shape.lines):
        bold = ' class="id"' if k == 0 else ""
        yield f'<text{bold} x="{w / 2:g}" y="{y + k * LINE:g}">{_text(line)}</text>'
    if element.kind in (GsnKind.ASSUMPTION, GsnKind.JUSTIFICATION):
        letter = element.kind[0].upper()
        yield f'<text class="id" x="{w - 8:g}" y="{h - 2:g}">{letter}</text>'
    yield "</g>"


_OUTLINES = {
    GsnKind.GOAL: '<rect{mark} width="{w}" height="{h}"/>',
    GsnKind.STRATEGY: '<polygon{mark} points="12,0 {w},0 {s},{h} 0,{h}"/>',
    GsnKind.SOLUTION: '<circle{mark} cx="{x}" cy="{y}" r="{x}"/>',
    GsnKind.CONTEXT: '<rect{mark} width="{w}" height="{h}" rx="14"/>',
    GsnKind.ASSUMPTION: '<ellipse{mark} cx="{x}" cy="{y}" rx="{x}" ry="{y}"/>',
    GsnKind.JUSTIFICATION: '<ellipse{mark} cx="{x}" cy="{y}" rx="{x}" ry="{y}"/>',
}


def _moved(parts: tuple[str, ...], x: float, y: float) -> tuple[str, ...]:
    return (f'<g transform="translate({x:g} {y:g})">', *parts, "</g>")


def _text(text: str) -> str:
    return escape(visible(text))
