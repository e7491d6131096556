"""What combines in one spec, on a page: a grid of pairs, and why some are refused."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from string import ascii_uppercase

from making.combinations import FEATURES, Answer, Feature, Pair
from making.tables import cell

# In the grid; a refusal has the number of its row instead.
_SIGNS = {Answer.TOGETHER: "", Answer.ALTERNATIVES: "/", Answer.LISTED: "L"}


@dataclass(frozen=True)
class Refusal:
    """Any of some features beside any of some others, by name, and what is said then."""

    some: tuple[str, ...]
    others: tuple[str, ...]
    why: str
    remedy: str

    def is_about(self, names: frozenset[str]) -> bool:
        """Tell whether a pair is one of those."""
        return any(names == {one, other} for one in self.some for other in self.others)


def combinations_tables(every: Sequence[Pair]) -> str:
    """Return the grid of all pairs, and below it why and what to do where one is refused."""
    refusals = list(_refusals(every))
    return "\n".join([*_grid(every, refusals), "", *_reasons(refusals)])


def _refusals(every: Sequence[Pair]) -> Iterator[Refusal]:
    """Gather the pairs that are refused with the same words, each pair once."""
    alike: dict[tuple[str, str], set[frozenset[str]]] = {}
    for pair in every:
        if pair.answer is Answer.REFUSED:
            alike.setdefault((pair.why, pair.remedy), set()).add(_names(*pair.features))
    names = [item.name for item in FEATURES]
    for words, left in alike.items():
        while left:
            beside = {
                name: tuple(other for other in names if {name, other} in left) for name in names
            }
            widest = max(beside.values(), key=len)
            some = tuple(name for name in names if beside[name] == widest)
            refusal = Refusal(some, widest, *words)
            left = {pair for pair in left if not refusal.is_about(pair)}
            yield refusal


def _names(*features: Feature) -> frozenset[str]:
    return frozenset(item.name for item in features)


def _grid(every: Sequence[Pair], refusals: Sequence[Refusal]) -> Iterator[str]:
    answers = {_names(*pair.features): pair.answer for pair in every}

    def sign(*features: Feature) -> str:
        names = _names(*features)
        if len(names) == 1:
            return '<td class="self"></td>'
        if answers[names] is not Answer.REFUSED:
            return f"<td>{_SIGNS[answers[names]]}</td>"
        number, item = next((k, item) for k, item in enumerate(refusals, 1) if item.is_about(names))
        title = escape(f"{' + '.join(one.name for one in features)}: {item.why}")
        return f'<td><a href="#refused-{number}" title="{title}">{number}</a></td>'

    heads = (
        f'<th scope="col" title="{escape(item.name)}">{letter}</th>' for letter, item in _lettered()
    )
    yield '<table class="pairs">'
    yield f'<thead><tr><th scope="col">what, and in a spec</th>{"".join(heads)}</tr></thead>'
    yield "<tbody>"
    for letter, item in _lettered():
        name = f"{letter}: {escape(item.name)}<br/><code>{escape(item.key)}</code>"
        cells = "".join(sign(item, other) for other in FEATURES)
        yield f'<tr><th scope="row">{name}</th>{cells}</tr>'
    yield "</tbody></table>"


def _lettered() -> Iterator[tuple[str, Feature]]:
    return zip(ascii_uppercase[: len(FEATURES)], FEATURES, strict=True)


def _reasons(refusals: Sequence[Refusal]) -> Iterator[str]:
    yield "|  | any of | beside any of | what is said | what to do |"
    yield "|---|---|---|---|---|"
    for number, item in enumerate(refusals, 1):
        texts = (", ".join(item.some), ", ".join(item.others), item.why, item.remedy)
        anchor = f'<span id="refused-{number}">{number}</span>'
        yield f"| {anchor} | {' | '.join(map(cell, texts))} |"
