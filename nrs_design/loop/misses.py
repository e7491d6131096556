"""The modes of a loop of which some steps miss their deadline: one for each outcome and state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

from nrs_design.errors import AssemblyError
from nrs_design.loop.located import MatrixMode
from nrs_design.loop.spot import Spot
from nrs_design.proof.switching import NOWHERE, Clock, Stay, Switching
from nrs_design.spec.misses import MissAutomaton, MissesSpec, automaton_of

MAX_TRANSITIONS = 200_000
ONCE = Stay(Fraction(1), Fraction(1))


def modes_with_misses(
    items: Sequence[MatrixMode], rule: MissesSpec
) -> tuple[tuple[MatrixMode, ...], Switching]:
    """Return the modes by the automaton state after them, and the allowed switches.

    What may follow depends on the state of the automaton alone, so a mode is named by the state
    that it leads to, such as ``miss/s3``. Corners of one mode may take turns at every step. All
    groups but that of a miss are hits. An `AssemblyError` if there are too many switches.
    """
    automaton = automaton_of(*rule.window)
    # Modes by miss and by the state after them, in the order of states.
    reached: dict[tuple[bool, int], tuple[MatrixMode, ...]] = {}
    for missed, targets in ((False, automaton.hit), (True, automaton.miss)):
        corners = [item for item in items if (item.group == rule.mode) is missed]
        for target in sorted({t for t in targets if t is not None}):
            reached[missed, target] = tuple(
                replace(item, spot=item.spot + Spot.named(f"s{target}")) for item in corners
            )
    transitions: list[tuple[str, str]] = []
    stays: list[tuple[str, Stay]] = []
    for (_, state), sources in reached.items():
        following = [(False, automaton.hit[state]), (True, automaton.miss[state])]
        after = [mode for missed, t in following if t is not None for mode in reached[missed, t]]
        names = {mode.name for mode in after}
        if (len(transitions) + len(sources) * len(after)) > MAX_TRANSITIONS:
            raise AssemblyError(
                f"the rule for misses makes more than {MAX_TRANSITIONS} switches",
                remedy="shorten its window, or declare fewer parameters",
                at=("misses",),
            )
        for source in sources:
            transitions += ((source.name, mode.name) for mode in after if mode is not source)
            if source.name not in names:
                stays.append((source.name, ONCE))
    modes = tuple(mode for corners in reached.values() for mode in corners)
    return modes, Switching(Fraction(1), tuple(transitions), stays=tuple(stays))


def clock_of(automaton: MissAutomaton, in_time: tuple[str, ...]) -> Clock:
    """Return which modes may be in force at a step, by the automaton of a rule."""
    pairs = zip(automaton.hit, automaton.miss, strict=True)
    ahead = ((hit, NOWHERE if miss is None else miss) for hit, miss in pairs)
    return Clock(automaton.count, in_time, tuple(ahead))
