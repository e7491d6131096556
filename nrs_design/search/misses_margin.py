"""How many deadlines may be missed: the most that is proved, and the fewest that are refuted."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict
from nrs_design.progress import Progress, silent
from nrs_design.search.loop_margin import Bracket, halve
from nrs_design.search.tried import Tried

if TYPE_CHECKING:
    from nrs_design.search.tried import Found


def find_most_misses(
    declared: int,
    most: int,
    decide: Callable[[int], Found],
    known: Found | None = None,
    progress: Progress = silent,
) -> Bracket:
    """Bracket how many steps may be missed, by doubling and bisecting, up to `most`.

    What may happen with few misses may happen with more: a proof for a number is one for every
    smaller one, and a refutation one for every larger one. `known` is on the declared number,
    perhaps by a longer search.
    """
    tried: Tried[int] = Tried(decide, progress, "misses")
    if known is not None:
        tried.remember(declared, known)
    if tried.is_proved(declared):
        _widen(declared, most, tried.is_proved)
    else:
        halve(0, declared, tried.is_proved)
    proved = max(tried.that_are(Verdict.PROVED), default=None)

    def bears(number: int) -> bool:
        return not (tried.is_refuted(number) or tried.makes_no_system(number))

    if tried.that_are(Verdict.REFUTED):
        first = min(tried.that_are(Verdict.REFUTED))
        halve(max((n for n in tried.all() if n < first), default=0), first, bears)
    else:
        _widen(max(n for n in tried.all() if not tried.makes_no_system(n)), most, bears)
    refuted = min(tried.that_are(Verdict.REFUTED), default=None)
    end = "" if refuted is not None else tried.end("of up to", "more make no system")
    ends = [None if number is None else Fraction(number) for number in (proved, refuted)]
    return Bracket(ends[0], ends[1], end, tried.refuted_in(refuted))


def _widen(inside: int, most: int, accepts: Callable[[int], bool]) -> None:
    """Double a number that is accepted until it is not, and bisect."""
    while inside < most:
        outside = min(2 * inside, most)
        if not accepts(outside):
            halve(inside, outside, accepts)
            return
        inside = outside
