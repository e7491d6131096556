"""Every check of a run against its bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace

from nrs_design.errors import DataError
from nrs_design.identification.running.bounds import BoundStatus, Check, RunBounds
from nrs_design.identification.running.log import RunLog
from nrs_design.identification.running.sector import judge_sector
from nrs_design.identification.running.signals import (
    judge_delay,
    judge_force,
    judge_jitter,
    judge_saturation,
)
from nrs_design.identification.running.stays import judge_stays

_NO_SURFACE = "a log does not say where its surface is"
_NO_LOSS = "a log does not say whether contact was lost"


@dataclass(frozen=True, slots=True, eq=False)
class RunJudgement:
    """All checks of a run."""

    log: RunLog  # The data
    bounds: RunBounds  # What the spec promises
    checks: tuple[Check, ...]  # One for each bound
    # Share of the rows in which a stiffness far off would show; None without a test.
    judged: float | None = None

    @property
    def first(self) -> Check | None:
        """The check that was violated first, or None."""
        left = [check for check in self.checks if check.first is not None]
        return min(left, key=lambda c: c.first.time if c.first else 0.0, default=None)

    @property
    def verdict(self) -> str:
        """``outside``, ``inside``, or ``inconclusive``."""
        statuses = {check.status for check in self.checks}
        if BoundStatus.OUTSIDE in statuses:
            return "outside"
        open_ends = statuses & {BoundStatus.UNDECIDED, BoundStatus.NOT_JUDGED}
        return "inside" if self.bounds.proved and not open_ends else "inconclusive"


def judge_run(
    log: RunLog,
    bounds: RunBounds,
    *,
    proved: bool,
    losable: bool = False,
    command_limit: float | None = None,
) -> RunJudgement:
    """Compare a log with the bounds of a spec, which a valid certificate proves or not.

    A command limit is in units of the command; by default that of the spec. A log whose command is
    of another kind than the spec's is a `DataError`.
    """
    if bounds.command == "rad/s":
        log = log.convert_to_radians()
    if log.command_unit not in ("", bounds.command):
        column = "command_" + bounds.command.replace("/", "_").replace("*", "")
        raise DataError(
            f"its command is read in {log.command_unit}, and the motor of the spec takes "
            f"{bounds.command}",
            path=log.source.path,
            remedy=f"name the column that the motor is sent {column} in its header, or leave the "
            "other out",
        )
    bounds = replace(bounds, proved=proved)
    tested, judged = judge_sector(log, bounds)
    checks = (
        *tested,
        _judge_contact(bounds, losable=losable if proved else bounds.losable),
        judge_stays(log, bounds),
        judge_delay(log, bounds),
        judge_jitter(log, bounds),
        judge_saturation(log, bounds, bounds.saturates if command_limit is None else command_limit),
        judge_force(log, bounds),
        *(
            Check.open(f"preload of {name}", _NO_SURFACE, allowed, bounds.assumed_by)
            for name, allowed in bounds.preloads.items()
        ),
    )
    return RunJudgement(log, bounds, checks, judged)


def _judge_contact(bounds: RunBounds, *, losable: bool | None) -> Check:
    """Return the check of lost contact; `losable` is None if nothing states it."""
    if losable:
        basis = "covered by the proof" if bounds.proved else "asked for by the spec, not proved"
        allowed = "lost and made again at any time"
        return Check("contact", BoundStatus.INSIDE, "may be lost", allowed, basis)
    if losable is None:
        basis = "`contact` of the spec, or a certificate, says whether it may be lost"
        return Check.open("contact", _NO_LOSS, "not said", basis)
    return Check.open("contact", _NO_LOSS, "kept all the time", f"assumption of {bounds.source}")
