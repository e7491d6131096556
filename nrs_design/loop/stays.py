"""Dwell times in a sampled loop: which controller may be in force at a sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil

from nrs_design.errors import AssemblyError
from nrs_design.proof.assumption import Assumption
from nrs_design.proof.evidence.fields import MAX_STATES
from nrs_design.proof.switching import NOWHERE, Clock
from nrs_design.proof.text import exact_text
from nrs_design.spec import SwitchingSpec
from nrs_design.spec.switching import ANY_SIGNAL


@dataclass(frozen=True, slots=True)
class CountedRules:
    """Rules of switching of a sampled loop: no mode has a dwell time of its own."""

    clock: Clock | None  # What dwell times allow; None where they forbid nothing
    rest: SwitchingSpec  # What it does not hold
    assumptions: tuple[Assumption, ...] = ()


def count_stays(
    rules: SwitchingSpec, modes: Mapping[str, Sequence[str]], period: Fraction
) -> CountedRules:
    """Return rules with stays that are counted in samples.

    `modes` are those of each controller, in contact and free, and follow each other freely; the
    period is the longest from sample to sample, in s. A state is how many samples a controller has
    been in force, up to its dwell time. An `AssemblyError` if there are too many of them.
    """
    names, counts = [*modes], [_count_samples(rules, name, period) for name in modes]
    if len(names) < 2 or max(counts) == 1:
        none = {"dwell_time": None, "longest_dwell_time": None}
        return CountedRules(None, rules.model_copy(update=none))
    if sum(counts) > MAX_STATES:
        most = MAX_STATES // len(names)
        raise AssemblyError(
            f"the dwell times are {sum(counts)} samples long, at most {MAX_STATES} are counted",
            remedy=f"write dwell times of up to {most} samples each, which is "
            f"{exact_text(most * period)} s: a longer stay keeps them",
            at=("switching", "dwell_time"),
        )
    first = [sum(counts[:k]) for k in range(len(counts))]
    allowed = None if rules.transitions is None else frozenset(rules.transitions)

    def leads(k: int, spent: int) -> tuple[int, ...]:
        """Return where each controller leads after so many samples of one."""
        last = counts[k] - 1
        to = [NOWHERE] * len(names)
        if spent == last:
            for other, name in enumerate(names):
                if allowed is None or (names[k], name) in allowed:
                    to[other] = first[other]
        to[k] = first[k] + min(spent + 1, last)
        return tuple(to)

    ahead = tuple(leads(k, spent) for k, count in enumerate(counts) for spent in range(count))
    own, *more = (tuple(found) for found in modes.values())
    clock = Clock(len(ahead), own, ahead, tuple(more[:-1]))
    each = tuple(f"{name} {count}" for name, count in zip(names, counts, strict=True))
    return CountedRules(clock, ANY_SIGNAL, (Assumption.create("rules.counted", counts=each),))


def _count_samples(rules: SwitchingSpec, name: str, period: Fraction) -> int:
    """Return how many samples a stay of a controller has at least."""
    shortest, _ = rules.stay(name)
    if shortest is None:
        return 1
    return max(ceil(shortest.value / period), 1)
