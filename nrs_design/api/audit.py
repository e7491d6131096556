"""How a run of the robot stands to what was proved, as the library gives it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from nrs_design.api.result import AbstractResult


@dataclass(frozen=True, slots=True)
class AuditCheck:
    """One bound and what the run says about it."""

    name: str  # What is judged
    # ``inside``, ``outside``, ``undecided``, ``estimated``, ``not judged``, ``not modelled``
    status: str
    measured: str  # What the log shows; for what is not judged, why
    allowed: str = ""  # The bound
    basis: str = ""  # Where the bound comes from
    time: float | None = None  # When it was first left, in s
    violation: str = ""  # What happened then


@dataclass(frozen=True, repr=False)
class Audit(AbstractResult):
    """Whether a run stayed inside what was proved.

    Parameters
    ----------
    name : str
        Of the spec.
    verdict : {"inside", "outside", "inconclusive"}
        Inside only if all was judged and the spec is proved.
    unproved_because : str
        Why the spec is not proved, so that its ranges are only declared; empty if it is.
    checks : tuple of AuditCheck
        One for each bound.
    first : AuditCheck or None
        That which was left first.
    synthetic : bool
        Whether a simulation made the log.
    facts : mapping
        What the command prints by ``--json``.
    """

    name: str
    verdict: str
    unproved_because: str
    checks: tuple[AuditCheck, ...]
    first: AuditCheck | None
    synthetic: bool
    facts: Mapping[str, Any]

    def _facts(self) -> dict[str, Any]:
        return dict(self.facts)

    def _headline(self) -> str:
        made = ", SYNTHETIC data" if self.synthetic else ""
        unproved = ", UNPROVED SPEC" if self.unproved_because else ""
        return f"{self.name}: {self.verdict}{made}{unproved}"

    def _rows(self) -> Iterator[Sequence[str]]:
        yield "check", "outcome", "measured", "allowed", "first at s"
        for check in self.checks:
            when = "" if check.time is None else f"{check.time:.6g}"
            yield check.name, check.status, check.measured, check.allowed, when

    def __bool__(self) -> bool:
        """Whether the run stayed inside; an open question does not count."""
        return self.verdict == "inside"
