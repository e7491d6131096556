"""What is not modelled together in one spec, as a page: the table that refuses it."""

from __future__ import annotations

import re
from collections.abc import Iterator

from making.tables import cell
from nrs_design.spec.combinations import COMBINATIONS

# What stands for the name that is found in a spec.
_NAMES = {
    "0": "X",
    "0.name": "X",
    "0[0]": "X",
    "0[1]": "Y",
    "0[2]": "Z",
    "0.contact": "X+Y",
    "0.controller": "C",
}


def combinations_table() -> str:
    """Return each feature, where a spec says it, and what it is refused beside."""
    return "\n".join(_rows())


def _rows() -> Iterator[str]:
    yield "| not modelled | in a spec | beside | what to do |"
    yield "|---|---|---|---|"
    for row in COMBINATIONS:
        first, *others = row.features
        texts = (_said(first.phrase), " and ".join(_said(item.phrase) for item in others))
        ways = dict.fromkeys(_filled(item.without) for item in row.features)
        what, beside = map(cell, texts)
        yield f"| {what} | `{_filled(first.at)}` | {beside} | {cell(', or '.join(ways))} |"


def _said(phrase: str) -> str:
    return _filled(phrase).removesuffix(",")


def _filled(text: str) -> str:
    named = re.sub(r"(?<!\{)\{(0[^!}]*)(?:!r)?\}", lambda found: _NAMES[found[1]], text)
    return named.replace("{{", "{").replace("}}", "}")
