"""Every check of a run against its bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from nrs_design.api.audit import AuditCheck, Status
from nrs_design.identification.datasets.records import FEWEST_ROWS, SignalRecord, longest_stretch
from nrs_design.identification.delay.identify import identify_delay
from nrs_design.identification.errors import DataError
from nrs_design.identification.rounding import noise_variance
from nrs_design.identification.running.bounds import RunBounds
from nrs_design.identification.running.dwell_times import judge_stays
from nrs_design.identification.running.log import RunLog
from nrs_design.identification.running.sector import judge_sector
from nrs_design.identification.statistics import joint_level, span, student_quantile
from nrs_design.proof.bounds import lower, upper

# Clocks of loop and log differ by less than this part of a period.
_UNEVEN = 0.01
_NO_SURFACE = "a log does not say where its surface is"
_NO_LOSS = "a log does not say whether contact was lost"


@dataclass(frozen=True, slots=True, eq=False)
class RunJudgement:
    """All checks of a run."""

    log: RunLog  # The data
    bounds: RunBounds  # What the spec promises
    checks: tuple[AuditCheck, ...]  # One for each bound
    # Share of the rows in which a stiffness far off would show; None without a test.
    judged_share: float | None = None

    @property
    def first(self) -> AuditCheck | None:
        """The check that was violated first, or None."""
        violated = [(c.time, i) for i, c in enumerate(self.checks) if c.time is not None]
        return self.checks[min(violated)[1]] if violated else None

    @property
    def verdict(self) -> str:
        """``outside``, ``inside``, or ``inconclusive``."""
        statuses = {check.status for check in self.checks}
        if "outside" in statuses:
            return "outside"
        open_ends = statuses & {"undecided", "not judged"}
        return "inside" if self.bounds.proved and not open_ends else "inconclusive"


def judge_run(
    log: RunLog, bounds: RunBounds, *, proved: bool, losable: bool = False
) -> RunJudgement:
    """Compare a log with the bounds of a spec, which a valid certificate proves or not.

    A log whose command is of another kind than the spec's is a `DataError`.
    """
    if bounds.command == "rad/s":
        log = log.convert_to_radians()
    if log.command_unit not in ("", bounds.command):
        column = "command_" + bounds.command.replace("/", "_").replace("*", "")
        raise DataError(
            f"its command is read in {log.command_unit}, and the motor of the spec takes "
            f"{bounds.command}",
            path=log.source.path,
            remedy=f"rename the column of the motor command to {column}, or leave the column out",
        )
    bounds = replace(bounds, proved=proved)
    tested, judged_share = judge_sector(log, bounds)
    checks = (
        *tested,
        _judge_contact(bounds, losable=losable if proved else bounds.losable),
        judge_stays(log, bounds),
        _judge_delay(log, bounds),
        _judge_jitter(log, bounds),
        _judge_saturation(log, bounds),
        _judge_force(log, bounds),
        *(
            AuditCheck(
                f"preload of {name}", "not judged", _NO_SURFACE, limit_text, bounds.assumption_basis
            )
            for name, limit_text in bounds.preloads.items()
        ),
    )
    return RunJudgement(log, bounds, checks, judged_share)


def _judge_contact(bounds: RunBounds, *, losable: bool | None) -> AuditCheck:
    """Judge lost contact; `losable` is None if neither spec nor certificate declares it."""
    if losable:
        basis = "covered by the proof" if bounds.proved else "asked for by the spec, not proved"
        limit_text = "lost and made again at any time"
        return AuditCheck("contact", "inside", "may be lost", limit_text, basis)
    if losable is None:
        basis = "`contact` of the spec, or a certificate, says whether it may be lost"
        return AuditCheck("contact", "not judged", _NO_LOSS, "not said", basis)
    basis = f"assumption of {bounds.source}"
    return AuditCheck("contact", "not judged", _NO_LOSS, "kept all the time", basis)


def _judge_delay(log: RunLog, bounds: RunBounds) -> AuditCheck:
    """Judge how late the motion follows the command."""
    signal = next((name for name in ("angle", "velocity") if name in log.columns), None)
    if "command" not in log.columns or signal is None:
        missing = "command" if "command" not in log.columns else "angle or velocity"
        return AuditCheck("delay", "not judged", f"no column for {missing}")
    rows = longest_stretch(log.time)
    if rows.stop - rows.start < FEWEST_ROWS:
        return AuditCheck("delay", "not judged", f"no {FEWEST_ROWS} rows without a gap")
    time, command, output = (
        a[rows] for a in (log.time, log.columns["command"], log.columns[signal])
    )
    try:
        found = identify_delay(
            SignalRecord(log.source, time - time[0], command, output, names=("command", signal))
        )
    except DataError as error:
        return AuditCheck("delay", "not judged", error.message)
    low, high = found.delay.low, found.delay.high
    if found.untold is not None:
        return AuditCheck("delay", "not judged", found.untold)
    outwards = f"[{lower(Fraction(low), 3)}, {upper(Fraction(high), 3)}]"
    words = f"{found.delay.value:.3g} {outwards} s"
    if found.doubts:
        return AuditCheck(
            "delay", "not judged", f"not determined by this record: {found.doubts[0]}"
        )
    if bounds.delay is None:
        return AuditCheck("delay", "not modelled", words, _time_of(bounds), bounds.assumption_basis)
    # A log with gaps is judged in its longest stretch only.
    whole = rows.stop - rows.start == len(log.time)
    status: Status = "inside" if high < bounds.delay and whole else "undecided"
    limit_text, basis = f"below {bounds.delay:g} s", "delay margin of the design"
    if low > bounds.delay:
        return AuditCheck("delay", "outside", words, limit_text, basis, log.begin, words)
    return AuditCheck("delay", status, words, limit_text, basis)


def _judge_jitter(log: RunLog, bounds: RunBounds) -> AuditCheck:
    """Judge how even the steps of time are."""
    steps = np.diff(log.time)
    words = f"steps of {span(steps.min(), steps.max(), 's')}, usually {log.step:.4g} s"
    if bounds.period is not None:
        # Rows come at every sample of the loop, or at every second one, and so on.
        count = max(round(log.step / bounds.period), 1)
        if abs(log.step - count * bounds.period) > _UNEVEN * bounds.period:
            words += f": no whole number of periods of {bounds.period:g} s"
    return AuditCheck("jitter", "not modelled", words, _time_of(bounds), bounds.assumption_basis)


def _time_of(bounds: RunBounds) -> str:
    """Say what time the model knows."""
    model = "proof" if bounds.proved else "spec"
    if bounds.period is None:
        return f"none: the {model} is in continuous time"
    period_text = f"every {bounds.period:g} s"
    if bounds.latency:
        return f"{bounds.latency} from a sample to its command in the {model}, {period_text}"
    return f"none: the {model} is about a motion without dead time, sampled {period_text}"


def _judge_saturation(log: RunLog, bounds: RunBounds) -> AuditCheck:
    """Judge whether the command met the limit of the driver."""
    limit = bounds.saturates
    if "command" not in log.columns:
        return AuditCheck("saturation", "not judged", "no column for command")
    size = np.abs(log.columns["command"])
    largest = f"largest command {size.max():.5g} {log.command_unit}"
    if limit is None:
        unknown = "where the driver saturates is not known: give the spec `limits: command`"
        return AuditCheck("saturation", "not judged", f"{largest}; {unknown}")
    limit_text = f"below {limit:g} {log.command_unit}"
    rows = np.flatnonzero(size >= limit)
    if not len(rows):
        return AuditCheck("saturation", "inside", largest, limit_text, bounds.assumption_basis)
    words = f"the command is {log.columns['command'][rows[0]]:.5g} {log.command_unit}"
    basis, time = bounds.assumption_basis, log.time_of(rows[0])
    return AuditCheck("saturation", "outside", largest, limit_text, basis, time, words)


def _judge_force(log: RunLog, bounds: RunBounds) -> AuditCheck:
    """Judge the torque against the limit of the design."""
    limit_text, basis = f"up to {bounds.torque:g} N m", "limit of the spec"
    if bounds.proved:
        basis += ", not of the proof"
    torque = log.columns.get("torque")
    if torque is None and "force" in log.columns and bounds.lever_arm is not None:
        torque = log.columns["force"] * bounds.lever_arm
    if torque is None:
        return AuditCheck("force", "not judged", "no column for torque or force", limit_text, basis)
    size = np.abs(torque)
    largest = f"largest torque {size.max():.4g} N m"
    # Largest noise of any row, at 95 % for all rows together.
    noise = student_quantile(len(size), joint_level(len(size)))
    noise *= float(np.sqrt(noise_variance(torque)))
    rows = np.flatnonzero(size - noise > bounds.torque)
    if not len(rows):
        status: Status = "undecided" if size.max() > bounds.torque else "inside"
        largest += f", noise up to {noise:.2g} N m"
        return AuditCheck("force", status, largest, limit_text, basis)
    words = f"the torque is {torque[rows[0]]:.4g} N m"
    time = log.time_of(rows[0])
    return AuditCheck("force", "outside", largest, limit_text, basis, time, words)
