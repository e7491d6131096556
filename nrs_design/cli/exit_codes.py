"""Exit codes of every command."""

from __future__ import annotations

PROVED = 0
REFUTED = 1
USAGE = 2
INCONCLUSIVE = 3
INTERNAL = 4
# As a shell says of a command that Ctrl-C ended.
INTERRUPTED = 130

OF_VERDICT = {"proved": PROVED, "refuted": REFUTED, "inconclusive": INCONCLUSIVE}
