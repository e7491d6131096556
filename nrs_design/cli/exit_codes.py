"""Exit codes of every command."""

from __future__ import annotations

from collections.abc import Collection

PROVED = 0
REFUTED = 1
USAGE = 2
INCONCLUSIVE = 3
INTERNAL = 4
# As a shell says of a command that Ctrl-C ended.
INTERRUPTED = 130

VERDICT_CODES = {"proved": PROVED, "refuted": REFUTED, "inconclusive": INCONCLUSIVE}
# By severity of the worst obligation of a gate, from none to a defect of this program.
SEVERITY_CODES = (PROVED, INCONCLUSIVE, REFUTED, USAGE, INTERNAL)


def unless(missed: object) -> int:
    """Return 1 if something is missed or refuted, else 0."""
    return REFUTED if missed else PROVED


def worst(codes: Collection[int]) -> int:
    """Return the code of the worst of several answers."""
    return max(codes, key=SEVERITY_CODES.index)
