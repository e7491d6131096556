"""How far delay, period and command of a loop stretch: proved and refuted side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.bounds import nearly

if TYPE_CHECKING:
    from nrs_design.proof.evidence.abstract import Bound

# A period is multiplied or divided by two so often, and then bisected.
DOUBLINGS, STEPS = 4, 4
# An exact test of a mode with more samples on their way takes too long.
FARTHEST_DELAY = 32


@dataclass(frozen=True)
class Bracket:
    """The largest number with a proof, and the smallest that is refuted; None where there is none.

    Parameters
    ----------
    proved, refuted : Fraction or None
        Delays in samples, periods in s.
    end : str
        Where the search for a refutation ended, and why there, if it found none.
    """

    proved: Fraction | None
    refuted: Fraction | None
    end: str = ""


@dataclass(frozen=True)
class CommandMargin:
    """Disturbances at which the limit of the force is proved to be kept, and those that break it.

    Parameters
    ----------
    limit : Fraction
        Of the force, in N m.
    bounds : mapping of str to (Fraction, Fraction, str)
        By disturbance: kept up to the first number, in the proportion in which the spec declares
        them; broken by a simulated run at the second one; with the unit.
    """

    limit: Fraction
    bounds: Mapping[str, tuple[Fraction, Fraction, str]]


@dataclass(frozen=True)
class MarginBrackets:
    """What `--margin` finds beside the box of ranges.

    Parameters
    ----------
    delay : Bracket or None
        Longest delay of the force sample, from the shortest declared one on; None without sampling.
    period : Bracket or None
        Periods, each for itself; None without sampling.
    command : CommandMargin or None
        None where no bound on the force is proved under the disturbances of the spec.
    """

    delay: Bracket | None
    period: Bracket | None
    command: CommandMargin | None


def find_longest_delay(
    shortest: int,
    declared: int,
    longest: int,
    decide: Callable[[int], Verdict],
    is_unstable: Callable[[int], bool],
) -> Bracket:
    """Find the longest delay with a proof, and the shortest that is refuted, in samples.

    The modes of a range of delays are those of every shorter range, and more: a proof for one is a
    proof for those, and a refutation one for every longer range. So beyond the delays that are
    decided, one that is unstable by itself refutes all ranges that reach it; and between the
    declared one and the longest, both ends are found by bisection.

    Parameters
    ----------
    shortest : int
        Smallest age of the force sample.
    declared : int
        Largest one in the spec.
    longest : int
        That is decided.
    decide : callable
        Gives the verdict on a largest age.
    is_unstable : callable
        Tells whether the loop is refuted where all samples have one age, by a test that is quick.
    """
    tried: dict[int, Verdict] = {}

    def is_found(delay: int, verdict: Verdict) -> bool:
        if delay not in tried:
            tried[delay] = decide(delay)
        return tried[delay] is verdict

    for delay in range(declared, shortest - 1, -1):
        if is_found(delay, Verdict.PROVED):
            break
    if tried[declared] is not Verdict.REFUTED and longest > declared:
        if not is_found(longest, Verdict.PROVED):
            _halve(declared, longest, lambda delay: is_found(delay, Verdict.PROVED))
        if Verdict.REFUTED in tried.values():
            beyond = min(delay for delay in tried if tried[delay] is Verdict.REFUTED)
            below = max((delay for delay in tried if delay < beyond), default=beyond)
            _halve(below, beyond, lambda delay: not is_found(delay, Verdict.REFUTED))
    proved = max((d for d in tried if tried[d] is Verdict.PROVED), default=None)
    refuted = min((d for d in tried if tried[d] is Verdict.REFUTED), default=None)
    if refuted is None:
        refuted = _first_unstable(longest, is_unstable)
    end = (
        ""
        if refuted is not None
        else f"none is refuted: no delay of up to {FARTHEST_DELAY} samples is shown to be unstable "
        "by itself, and an exact test of longer ones would take too long"
    )
    ends = [None if delay is None else Fraction(delay) for delay in (proved, refuted)]
    return Bracket(ends[0], ends[1], end)


def _halve(inside: int, outside: int, accepts: Callable[[int], bool]) -> int:
    """Bisect between a delay that is accepted and one that is not; return the first that is not."""
    while outside - inside > 1:
        middle = (inside + outside) // 2
        if accepts(middle):
            inside = middle
        else:
            outside = middle
    return outside


def _first_unstable(stable: int, is_unstable: Callable[[int], bool]) -> int | None:
    """Return a short delay that is unstable, beyond one that is not: by doubling and bisecting."""
    unstable = stable
    while not is_unstable(unstable):
        if unstable == FARTHEST_DELAY:
            return None
        stable, unstable = unstable, min(2 * unstable, FARTHEST_DELAY)
    return _halve(stable, unstable, lambda delay: not is_unstable(delay))


def find_longest_period(period: Fraction, decide: Callable[[Fraction], Verdict | str]) -> Bracket:
    """Find a long period with a proof and a short one that is refuted, each for itself.

    Other periods make other systems: nothing follows from one for the ones in between.

    Parameters
    ----------
    period : Fraction
        Of the spec, in s.
    decide : callable
        Gives the verdict on a period, or says why it makes no system.
    """
    tried: dict[Fraction, Verdict | str] = {period: decide(period)}

    def attempt(value: Fraction) -> Verdict | str:
        if value not in tried:
            tried[value] = decide(value)
        return tried[value]

    def double(factor: Fraction, end: Verdict) -> None:
        value = period
        for _ in range(DOUBLINGS):
            value *= factor
            if attempt(value) is end or not isinstance(tried[value], Verdict):
                break

    if tried[period] is not Verdict.PROVED:
        double(Fraction(1, 2), Verdict.PROVED)
    if Verdict.REFUTED not in tried.values():
        double(Fraction(2), Verdict.REFUTED)
    proved = _bisect(attempt, tried, Verdict.PROVED)
    refuted = _bisect(attempt, tried, Verdict.REFUTED)
    return Bracket(proved, refuted, "" if refuted is not None else _end_of_periods(tried))


def _end_of_periods(tried: Mapping[Fraction, Verdict | str]) -> str:
    """Say where periods that are not refuted end, and why there."""
    longest = max(value for value, found in tried.items() if isinstance(found, Verdict))
    faults = [found for value, found in sorted(tried.items()) if value > longest]
    why = f"a longer one makes no loop ({faults[0]})" if faults else "the search ends there"
    return f"none of up to {nearly(longest, 's')} is refuted: {why}"


def _bisect(
    attempt: Callable[[Fraction], Verdict | str],
    tried: Mapping[Fraction, Verdict | str],
    verdict: Verdict,
) -> Fraction | None:
    """Sharpen the largest period that is proved, or the smallest that is refuted."""
    mine = [value for value, found in tried.items() if found is verdict]
    if not mine:
        return None
    up = verdict is Verdict.PROVED
    best = max(mine) if up else min(mine)
    beyond = [v for v in tried if (v > best if up else v < best)]
    if not beyond:
        return best
    other = min(beyond) if up else max(beyond)
    for _ in range(STEPS):
        middle = (best + other) / 2
        if attempt(middle) is verdict:
            best = middle
        else:
            other = middle
    return best


def command_margin(found: Bound, reached: float) -> CommandMargin | None:
    """Return what the disturbances may be for the limit of an output, by proportion.

    Parameters
    ----------
    found : Bound
        Checked: under all disturbances at once.
    reached : float
        The output that a simulated run reaches under them.
    """
    limit = found.output.limit
    if limit is None or not reached > 0:
        return None
    kept, broken = limit / found.level, limit / Fraction(reached)
    return CommandMargin(
        limit, {c.name: (kept * c.bound, broken * c.bound, c.unit) for c in found.channels}
    )
