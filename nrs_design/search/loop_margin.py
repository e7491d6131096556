"""How far delay, period, misses and command of a loop stretch: proved and refuted side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict
from nrs_design.progress import Progress, silent
from nrs_design.search.tried import Tried, sharpened

if TYPE_CHECKING:
    from nrs_design.proof.evidence.abstract import Bound
    from nrs_design.search.tried import Found

# A period is multiplied or divided by two so often, and then bisected.
DOUBLINGS, STEPS = 4, 4
# An exact test of a mode with more samples on their way takes too long.
FARTHEST_DELAY = 32


@dataclass(frozen=True)
class Bracket:
    """The largest number with a proof, and the smallest that is refuted, where there are any."""

    # proved, refuted: delays in samples, periods in s, numbers of misses.
    proved: Fraction | None
    refuted: Fraction | None
    end: str = ""  # Where the search for a refutation ended, and why there, if it found none
    # In which contact alone it is refuted, where its loss must be covered; empty for any.
    refuted_in: str = ""


@dataclass(frozen=True)
class CommandMargin:
    """Disturbances under which the force limit is proved to be kept, and those that break it."""

    limit: Fraction  # Of the force, in N m
    # By disturbance: kept up to the first number, in the proportion in which the spec declares
    # them; broken by a simulated run at the second one; with the unit.
    bounds: Mapping[str, tuple[Fraction, Fraction, str]]


@dataclass(frozen=True)
class MarginBrackets:
    """What `--margin` finds beside the box of ranges."""

    # Longest delay of the force sample, from the shortest declared one on; None without sampling.
    delay: Bracket | None
    period: Bracket | None  # Periods, each for itself; None without sampling
    # None where no bound on the force is proved under the disturbances of the spec.
    command: CommandMargin | None


def find_longest_delay(
    shortest: int,
    declared: int,
    longest: int,
    decide: Callable[[int], Found],
    unstable_in: Callable[[int], str | None],
    known: Found | None = None,
    progress: Progress = silent,
) -> Bracket:
    """Find the longest delay with a proof, and the shortest that is refuted, in samples.

    The modes of a range of delays are those of every shorter range, and more: a proof for one is a
    proof for those, and a refutation one for every longer range. So beyond the delays that are
    decided, one that is unstable by itself refutes all ranges that reach it (`unstable_in`, a quick
    test, tells in which contact, empty for any); and between the declared one and the longest, both
    ends are found by bisection. `known` is on the declared delay, perhaps by a longer search.
    """
    tried: Tried[int] = Tried(decide, progress, "delay")
    if known is not None:
        tried.remember(declared, known)
    for delay in range(declared, shortest - 1, -1):
        if tried.is_proved(delay):
            break
    if not tried.is_refuted(declared) and longest > declared:
        if not tried.is_proved(longest):
            halve(declared, longest, tried.is_proved)
        if tried.that_are(Verdict.REFUTED):
            beyond = min(tried.that_are(Verdict.REFUTED))
            below = max((delay for delay in tried.all() if delay < beyond), default=beyond)
            halve(below, beyond, lambda delay: not tried.is_refuted(delay))
    proved = max(tried.that_are(Verdict.PROVED), default=None)
    refuted = min(tried.that_are(Verdict.REFUTED), default=None)
    where = tried.refuted_in(refuted)
    if refuted is None:
        refuted = longest
        if unstable_in(longest) is None:
            refuted = _first_beyond(longest, FARTHEST_DELAY, lambda n: unstable_in(n) is None)
        where = "" if refuted is None else unstable_in(refuted) or ""
    ends = [None if delay is None else Fraction(delay) for delay in (proved, refuted)]
    end = "" if refuted is not None else _end_of_delays(tried)
    return Bracket(ends[0], ends[1], end, where)


def _end_of_delays(tried: Tried[int]) -> str:
    """Say why no delay is refuted."""
    why = f"a longer one makes no loop ({fault}), " if (fault := tried.fault()) else ""
    return (
        f"none is refuted: {why}no delay of up to {FARTHEST_DELAY} samples is shown to be unstable "
        "by itself, and an exact test of longer ones would take too long"
    )


def halve(inside: int, outside: int, accepts: Callable[[int], bool]) -> int:
    """Return the first number that is not accepted, between one that is and one that is not."""
    while outside - inside > 1:
        middle = (inside + outside) // 2
        if accepts(middle):
            inside = middle
        else:
            outside = middle
    return outside


def _first_beyond(inside: int, most: int, accepts: Callable[[int], bool]) -> int | None:
    """Return the first number that is not accepted, by doubling and bisecting; None up to most."""
    while inside < most:
        outside = min(2 * inside, most)
        if not accepts(outside):
            return halve(inside, outside, accepts)
        inside = outside
    return None


def find_longest_period(
    period: Fraction,
    decide: Callable[[Fraction], Found],
    known: Found | None = None,
    progress: Progress = silent,
) -> Bracket:
    """Find a long period with a proof and a short one that is refuted, each for itself, in s.

    Other periods make other systems: nothing follows from one for the ones in between. `known` is
    on the period of the spec, perhaps by a longer search.
    """
    tried = Tried(decide, progress, "period", "s")
    if known is not None:
        tried.remember(period, known)

    def double(factor: Fraction, end: Verdict) -> None:
        value = period
        for _ in range(DOUBLINGS):
            value *= factor
            if tried(value) is end or tried.makes_no_system(value):
                break

    if not tried.is_proved(period):
        double(Fraction(1, 2), Verdict.PROVED)
    if not tried.that_are(Verdict.REFUTED):
        double(Fraction(2), Verdict.REFUTED)
    proved = sharpened(tried, Verdict.PROVED, STEPS, up=True)
    refuted = sharpened(tried, Verdict.REFUTED, STEPS, up=False)
    end = "" if refuted is not None else tried.end("of up to", "a longer one makes no loop")
    return Bracket(proved, refuted, end, tried.refuted_in(refuted))


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
        _first_beyond(declared, most, tried.is_proved)
    else:
        halve(0, declared, tried.is_proved)
    proved = max(tried.that_are(Verdict.PROVED), default=None)

    def bears(number: int) -> bool:
        return not (tried.is_refuted(number) or tried.makes_no_system(number))

    if tried.that_are(Verdict.REFUTED):
        first = min(tried.that_are(Verdict.REFUTED))
        halve(max((n for n in tried.all() if n < first), default=0), first, bears)
    else:
        _first_beyond(max(n for n in tried.all() if not tried.makes_no_system(n)), most, bears)
    refuted = min(tried.that_are(Verdict.REFUTED), default=None)
    end = "" if refuted is not None else tried.end("of up to", "more make no system")
    ends = [None if number is None else Fraction(number) for number in (proved, refuted)]
    return Bracket(ends[0], ends[1], end, tried.refuted_in(refuted))


def command_margin(found: Bound, reached: float) -> CommandMargin | None:
    """Return what the disturbances may be for the limit of an output, by proportion.

    `reached` is what the output of a simulated run reaches under the disturbances of a checked
    bound.
    """
    limit = found.output.limit
    if limit is None or not reached > 0:
        return None
    kept, broken = limit / found.level, limit / Fraction(reached)
    return CommandMargin(
        limit, {c.name: (kept * c.bound, broken * c.bound, c.unit) for c in found.channels}
    )
