"""Whether a run stayed inside what was proved."""

from nrs_design.identification.running.bounds import (
    RunBounds,
    bounds_of_spec,
    read_run_bounds,
)
from nrs_design.identification.running.check import BoundStatus, Check, Violation
from nrs_design.identification.running.judge import RunJudgement, judge_run
from nrs_design.identification.running.log import RunLog, read_run

__all__ = [
    "BoundStatus",
    "Check",
    "RunBounds",
    "RunJudgement",
    "RunLog",
    "Violation",
    "bounds_of_spec",
    "judge_run",
    "read_run",
    "read_run_bounds",
]
