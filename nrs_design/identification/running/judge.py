"""Every check of a run against its bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import floor

from nrs_design.errors import DataError
from nrs_design.identification.running.bounds import RunBounds
from nrs_design.identification.running.check import BoundStatus, Check
from nrs_design.identification.running.contact import ESTIMATE, estimate_contact
from nrs_design.identification.running.log import RunLog
from nrs_design.identification.running.sector import hint, judge_sector
from nrs_design.identification.running.signals import (
    judge_delay,
    judge_force,
    judge_jitter,
    judge_saturation,
)
from nrs_design.identification.running.stays import judge_stays
from nrs_design.identification.running.stiffness import Window

# In s; long enough for some rows of any loop, short beside the motion of a hand.
WINDOW = 0.5
_NO_SURFACE = "a log does not say where its surface is"


@dataclass(frozen=True, slots=True, eq=False)
class RunJudgement:
    """All checks of a run."""

    log: RunLog  # The data
    bounds: RunBounds  # What the spec promises
    checks: tuple[Check, ...]  # One for each bound
    windows: tuple[Window, ...]  # Stiffness at the pivot in N m/rad, estimated
    share: float  # Of the time of the log, in which stiffness or free motion could be estimated
    # Of the rows, in which a stiffness far off would have been told; None if nothing tells.
    judged: float | None = None

    @property
    def first(self) -> Check | None:
        """The check that was violated first, or None."""
        left = [check for check in self.checks if check.first is not None]
        return min(left, key=lambda c: c.first.time if c.first else 0.0, default=None)

    @property
    def estimates(self) -> str:
        """What was estimated, for how much of the time (rounded down), and what that is not."""
        share = floor(1000 * self.share) / 10
        names = ", ".join(c.name for c in self.checks if c.status is BoundStatus.ESTIMATED)
        told = f"stiffness or free motion shows in {share:g} % of the time"
        return f"estimated, not judged: {names}: {ESTIMATE}; {told}" if names else told

    @property
    def hint(self) -> str:
        """Why the stiffness is not tested, and how it would be; empty if it is."""
        return hint(self.log, self.bounds)

    @property
    def verdict(self) -> str:
        """``outside``, ``inside``, or ``inconclusive``."""
        statuses = {check.status for check in self.checks}
        if BoundStatus.OUTSIDE in statuses:
            return "outside"
        open_ends = statuses & {
            BoundStatus.UNDECIDED,
            BoundStatus.ESTIMATED,
            BoundStatus.NOT_JUDGED,
        }
        return "inside" if self.bounds.proved and not open_ends else "inconclusive"


def _check_unit(log: RunLog, bounds: RunBounds) -> None:
    """Refuse a command that the motor of the spec does not take."""
    if log.command_unit in ("", bounds.command):
        return
    raise DataError(
        f"its command is read in {log.command_unit}, and the motor of the spec takes "
        f"{bounds.command}",
        path=log.source.path,
        remedy=f"name the column that the motor is sent command_{bounds.command} in its header, "
        "or leave the other out",
    )


def judge_run(
    log: RunLog,
    bounds: RunBounds,
    *,
    proved: bool,
    losable: bool = False,
    window: float = WINDOW,
    command_limit: float | None = None,
) -> RunJudgement:
    """Compare a log with the bounds of a spec, which a valid certificate proves or not.

    Windows of stiffness are in s. A command limit is in units of the command; by default that of
    the spec. A log whose command is of another kind than the spec's is a `DataError`.
    """
    _check_unit(log, bounds)
    bounds = replace(bounds, proved=proved)
    touch = estimate_contact(log, bounds, window, losable=losable if proved else bounds.losable)
    estimated, contact = touch.checks
    tested, judged = judge_sector(log, bounds) or ((estimated,), None)
    checks = (
        *tested,
        contact,
        judge_stays(log, bounds),
        judge_delay(log, bounds),
        judge_jitter(log, bounds),
        judge_saturation(log, bounds, bounds.saturates if command_limit is None else command_limit),
        judge_force(log, bounds),
        *(
            Check.open(f"preload of {name}", _NO_SURFACE, allowed, bounds.granted)
            for name, allowed in bounds.preloads.items()
        ),
    )
    return RunJudgement(log, bounds, checks, touch.windows, touch.share, judged)
