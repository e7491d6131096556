"""Rules of missed deadlines in a discrete loop, and the words that they allow.

Such loops are called weakly hard (Bernat, Burns and Llamosi 2001).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import takewhile
from math import comb
from typing import Annotated, Any, Literal

from nrs_design.spec.check import Row
from nrs_design.spec.fields import Label, whole
from nrs_design.spec.model import SpecModel, optional, required

MOST_STEPS = 1000
MOST_STATES = 1000
_Count = Annotated[int, whole(1, MOST_STEPS)]

# Word for a missed deadline in names of modes.
MISS = "miss"


def _checks(example: str, otherwise: str) -> tuple[Row[Any], ...]:
    """Return what a rule must be.

    `example` stands in a rule beside its numbers, with a comma; `otherwise` is to be written where
    all may be missed.
    """
    return (
        Row(
            "",
            lambda s: (s.consecutive is None) == (s.at_most is None and s.of is None),
            "a rule for misses is a window, or a number of misses in a row",
            f"write `{{{{{example}at_most: 2, of: 10}}}}`, or `{{{{{example}consecutive: 3}}}}`",
        ),
        Row(
            "",
            lambda s: s.consecutive is None and (s.at_most is None) != (s.of is None),
            "at_most and of belong together",
            "write both, such as `at_most: 2, of: 10`",
        ),
        Row(
            "of",
            lambda s: None not in (s.at_most, s.of) and s.of <= s.at_most and (s.of, s.at_most),
            "of any {0} steps, at most {1} may be missed: that is every one",
            f"write a longer window{otherwise}",
        ),
        Row(
            "of",
            lambda s: (
                None not in (s.at_most, s.of) and (n := comb(s.of, s.at_most)) > MOST_STATES and n
            ),
            f"the rule has {{0}} states, at most {MOST_STATES} are built",
            "write a shorter window",
        ),
    )


class MissRuleSpec(SpecModel, stronger="larger"):
    """In any so many steps in a row, at most some are missed."""

    at_most: _Count | None = optional("how many of `of` steps in a row may be missed")
    of: _Count | None = optional("length of the window, in steps", stronger="smaller")
    consecutive: _Count | None = optional("instead of both: how many steps in a row may be missed")

    @property
    def window(self) -> tuple[int, int]:
        """Return the largest number of misses, and in how many steps."""
        if self.consecutive is not None:
            return self.consecutive, self.consecutive + 1
        assert self.at_most is not None
        assert self.of is not None
        return self.at_most, self.of

    @property
    def states(self) -> int:
        """Return the number of states of its automaton."""
        most, of = self.window
        return comb(of, most)

    def said(self, of: str) -> str:
        """Say the rule in a few words, such as ``at most 2 of any 10 periods in a row``."""
        if self.consecutive is not None:
            return f"at most {self.consecutive} {of}{'s' * (self.consecutive > 1)} in a row"
        return f"at most {self.at_most} of any {self.of} {of}s in a row"


class MissesSpec(MissRuleSpec):
    """In any so many steps in a row, at most some are in the mode of a miss."""

    mode: Label = required("name of the mode that a missed deadline brings about")

    def __str__(self) -> str:
        """Say the rule in a few words."""
        return f"{self.said('step')} in {self.mode}"

    checks = _checks("mode: miss, ", ", or `switching: arbitrary`")


class DeadlinesSpec(MissRuleSpec):
    """The rule of missed deadlines of a sampled loop, and what the robot does in missed periods.

    A job that misses is dropped (kill): the law keeps its states, and there is no new command. The
    drive is held or zeroed meanwhile (Maggio et al., Control-System Stability under Consecutive
    Deadline Misses Constraints, 2020).
    """

    command: Literal["hold", "zero"] = required(
        "command in a period with a missed deadline: `hold` the one before, or `zero`"
    )
    job: Literal["kill", "skip"] = optional(
        "a job that misses its deadline: `kill` drops it; `skip` is refused", "kill"
    )

    def __str__(self) -> str:
        """Say the rule in a few words."""
        # Without the words before the number, as sentences go on with it.
        return self.said("period").removeprefix("at most ")

    checks = (
        *_checks("command: hold, ", ""),
        Row(
            "job",
            lambda s: s.job == "skip",
            "a job that goes on after its deadline is not modelled as a miss of its own",
            "write `job: kill`, and as `latency` the range of times to the command of a job that "
            "goes on, such as `latency: [0 ms, 4 ms]`: the period that it skips is the one that "
            "counts as missed",
        ),
    )


@dataclass(frozen=True, slots=True)
class MissAutomaton:
    """Minimal automaton of the words of hits and misses under a rule; any state may be first."""

    # For each state, the next states after a hit and after a miss; None if no miss is allowed.
    hit: tuple[int, ...]
    miss: tuple[int | None, ...]

    @property
    def count(self) -> int:
        """How many states there are."""
        return len(self.hit)


def automaton_of(at_most: int, of: int) -> MissAutomaton:
    """Return the automaton of a window, with the fewest states: ``of`` over ``at_most``.

    A state is how long ago the misses were that still bound what follows. The i-th youngest, a
    steps ago, leaves at most ``at_most - i`` misses for the next ``of - 1 - a`` steps; where these
    are no more than that, neither it nor an older one bounds anything, after any further steps.
    """

    def bounding(ages: tuple[int, ...]) -> tuple[int, ...]:
        each = enumerate(ages, 1)
        return tuple(
            a for _, a in takewhile(lambda item: of - 1 - item[1] > at_most - item[0], each)
        )

    # The youngest first.
    found: dict[tuple[int, ...], int] = {(): 0}
    hits, misses = list[int](), list[int | None]()
    waiting = [*found]

    def place(ages: tuple[int, ...]) -> int:
        if (kept := bounding(ages)) not in found:
            found[kept] = len(found)
            waiting.append(kept)
        return found[kept]

    for state in waiting:
        older = tuple(age + 1 for age in state)
        hits.append(place(older))
        misses.append(place((0, *older)) if len(state) < at_most else None)
    return MissAutomaton(tuple(hits), tuple(misses))
