"""How long a time in an interval may be: the longest that is proved, the shortest that is not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict
from nrs_design.progress import Progress, silent
from nrs_design.search.loop_margin import Bracket
from nrs_design.search.tried import Tried, sharpen

if TYPE_CHECKING:
    from nrs_design.search.tried import Found

# The longest time is doubled so often; a bracket is halved so often.
DOUBLINGS, STEPS = 4, 6


@dataclass(frozen=True)
class TimingMargin:
    """How far the longest times of a sampled loop reach, each with the other as declared."""

    period: Bracket
    delay: Bracket | None  # None where none is declared


def find_longest_time(
    what: str,
    shortest: Fraction,
    declared: Fraction,
    most: Fraction | None,
    decide: Callable[[Fraction], Found],
    known: Found | None = None,
    progress: Progress = silent,
) -> Bracket:
    """Bracket the longest time of an interval whose shortest one stays, by doubling and bisecting.

    What may happen in an interval may happen in a longer one: a proof for it is one for every
    shorter one, and a refutation one for every longer one.

    Parameters
    ----------
    what : str
        By which it is told.
    shortest, declared : Fraction
        The ends of the interval in the spec, in s.
    most : Fraction or None
        The longest time that makes a system, in s, if there is one.
    decide : callable
        Gives the verdict on a longest time, or says why it makes no system.
    known : Certification or Verdict, optional
        On the declared time, perhaps by a longer search.
    progress : callable
        Told each time, and what is known by then.
    """
    tried: Tried[Fraction] = Tried(decide, progress, what, "s")
    if known is not None:
        tried.remember(declared, known)
    end = declared
    for _ in range(DOUBLINGS):
        if tried.is_refuted(end) or tried.makes_no_system(end) or end == most:
            break
        end = 2 * end if most is None else min(2 * end, most)
    tried(end)
    if not tried.that_are(Verdict.PROVED) and shortest < min(tried.all()):
        tried(shortest)
    inside = max(tried.that_are(Verdict.PROVED), default=None)
    if inside is not None and (beyond := [t for t in tried.all() if t > inside]):
        sharpen(inside, min(beyond), STEPS, tried.is_proved)
    outside = min(tried.that_are(Verdict.REFUTED), default=None)
    if outside is not None and (below := [t for t in tried.all() if t < outside]):
        outside = sharpen(outside, max(below), STEPS, tried.is_refuted)
    # What does not refute may prove.
    inside = max(tried.that_are(Verdict.PROVED), default=None)
    end_words = "" if outside is not None else tried.end("of up to", "a longer one makes no system")
    return Bracket(inside, outside, end_words)
