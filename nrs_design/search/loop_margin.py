"""How far delay, period and command of a loop stretch: proved and refuted side."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict

if TYPE_CHECKING:
    from nrs_design.proof.evidence import InvariantEllipsoid
    from nrs_design.proof.system import SwitchedSystem

# A period is multiplied or divided by two so often, and then bisected.
DOUBLINGS, STEPS = 4, 4


@dataclass(frozen=True)
class Bracket:
    """The largest number with a proof, and the smallest that is refuted; None where there is none.

    Parameters
    ----------
    proved, refuted : Fraction or None
        Delays in samples, periods in s.
    """

    proved: Fraction | None
    refuted: Fraction | None


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
class LoopMargins:
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
    shortest: int, declared: int, longest: int, decide: Callable[[int], Verdict]
) -> Bracket:
    """Find the longest delay with a proof, and the shortest that is refuted, in samples.

    The modes of a range of delays are those of every shorter range, and more: a proof for one is a
    proof for those, and a refutation one for every longer range.

    Parameters
    ----------
    shortest : int
        Smallest age of the force sample.
    declared : int
        Largest one in the spec.
    longest : int
        That is looked at.
    decide : callable
        Gives the verdict on a largest age.
    """
    proved: int | None = None
    refuted: int | None = None
    for delay in [declared, *range(declared - 1, shortest - 1, -1)]:
        verdict = decide(delay)
        if verdict is Verdict.PROVED:
            proved = delay
            break
        refuted = delay if verdict is Verdict.REFUTED else refuted
    for delay in range(declared + 1, longest + 1):
        if refuted is not None:
            break
        verdict = decide(delay)
        if verdict is Verdict.PROVED:
            proved = delay
        refuted = delay if verdict is Verdict.REFUTED else None
    return Bracket(*(None if end is None else Fraction(end) for end in (proved, refuted)))


def find_longest_period(period: Fraction, decide: Callable[[Fraction], Verdict | None]) -> Bracket:
    """Find a long period with a proof and a short one that is refuted, each for itself.

    Other periods make other systems: nothing follows from one for the ones in between.

    Parameters
    ----------
    period : Fraction
        Of the spec, in s.
    decide : callable
        Gives the verdict on a period; None where it makes no system.
    """
    tried = {period: decide(period)}

    def attempt(value: Fraction) -> Verdict | None:
        if value not in tried:
            tried[value] = decide(value)
        return tried[value]

    factor = 2 if tried[period] is Verdict.PROVED else Fraction(1, 2)
    end = Verdict.PROVED if factor < 1 else Verdict.REFUTED
    value = period
    for _ in range(DOUBLINGS):
        value *= factor
        if attempt(value) in (end, None):
            break
    proved = _bisect(attempt, tried, Verdict.PROVED)
    refuted = _bisect(attempt, tried, Verdict.REFUTED)
    return Bracket(proved, refuted)


def _bisect(
    attempt: Callable[[Fraction], Verdict | None],
    tried: Mapping[Fraction, Verdict | None],
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


def command_margin(
    system: SwitchedSystem, found: InvariantEllipsoid, reached: float
) -> CommandMargin | None:
    """Return what the disturbances may be for the limit of an output, by proportion.

    Parameters
    ----------
    system : SwitchedSystem
        What the bound is about.
    found : InvariantEllipsoid
        Checked: under all disturbances at once.
    reached : float
        The output that a simulated run reaches under them.
    """
    output = next(item for item in system.outputs if item.name == found.output)
    if output.limit is None or not reached > 0:
        return None
    kept, broken = output.limit / found.level, output.limit / Fraction(reached)
    return CommandMargin(
        output.limit,
        {c.name: (kept * c.bound, broken * c.bound, c.unit) for c in found.acting(system)},
    )
