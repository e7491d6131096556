"""Comparison of a robot run with the proof, as a result of the library."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from nrs_design.api.result import AbstractResult

# Undecided: intervals lie across the bound. Not modelled: the proof assumes that the effect is
# absent, and has no bound.
Status = Literal["inside", "outside", "undecided", "not judged", "not modelled"]


@dataclass(frozen=True, slots=True)
class AuditCheck:
    """One bound and what the run says about it."""

    name: str  # What is judged
    status: Status  # The outcome
    measured: str  # Measured value; without a judgement, the reason
    allowed: str = ""  # The bound
    basis: str = ""  # Where the bound comes from
    time: float | None = None  # Time of the first violation, in s
    violation: str = ""  # What happened then


@dataclass(frozen=True, repr=False)
class Audit(AbstractResult):
    """Whether a run stayed inside what was proved."""

    name: str  # Name of the spec
    verdict: (
        str  # ``inside`` if all was judged and the spec is proved; ``outside``, ``inconclusive``
    )
    unproved_because: str  # Reason why the spec is not proved: its ranges are only declared
    checks: tuple[AuditCheck, ...]  # One for each bound
    first: AuditCheck | None  # The bound that was left first
    synthetic: bool  # Whether a simulation made the log
    facts: Mapping[str, Any]  # Content of ``--json``

    def _facts(self) -> dict[str, Any]:
        return dict(self.facts)

    def _headline(self) -> str:
        data_note = ", SYNTHETIC data" if self.synthetic else ""
        unproved = ", UNPROVED SPEC" if self.unproved_because else ""
        return f"{self.name}: {self.verdict}{data_note}{unproved}"

    def _rows(self) -> Iterator[Sequence[str]]:
        yield "check", "outcome", "measured", "allowed", "first at s"
        for check in self.checks:
            time_text = "" if check.time is None else f"{check.time:.6g}"
            yield check.name, check.status, check.measured, check.allowed, time_text

    def __bool__(self) -> bool:
        """Whether the run stayed inside; an open question does not count."""
        return self.verdict == "inside"
