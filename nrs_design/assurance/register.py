"""The register of assumptions by id: who covers each, its test, and what the test found."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from nrs_design.assurance.results import RecordedTest, RecordedTests
from nrs_design.reporting.register import Entry, register_of
from nrs_design.switched.assumption import Assumption, AssumptionKind, Standing

if TYPE_CHECKING:
    from nrs_design.pipeline import Result

# Who covers what is taken for granted, until a test says more.
COVERED_BY = {
    Standing.TESTED: "records that the spec names",
    Standing.ARGUED: "how the controller is made",
    Standing.OPEN: "nobody yet",
}
_NO_TEST = "not needed"


class RecordState(StrEnum):
    """What is known from the user's tests of one assumption, or of one step to the robot."""

    PASSED = "passed"
    FAILED = "failed"
    OTHER_SPEC = "tested with another spec"
    NOT_NEEDED = "no test needed"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class RegisterRow:
    """All that a certificate takes for granted under one id."""

    id: str  # Of the sentence, such as ``tissue.linear``
    kind: AssumptionKind  # What breaks if it is false, and how to test it
    statements: tuple[str, ...]  # As the certificate says them; one test covers them all
    bounds: tuple[str, ...]  # Within what they must hold
    standing: Standing
    state: RecordState
    test: RecordedTest | None  # What the user recorded; None without a record

    @property
    def covered_by(self) -> str:
        """Who covers it: the user's test, where one counts."""
        if self.state is RecordState.NOT_NEEDED:
            return "the proof itself"
        return "the user's test" if self.state is RecordState.PASSED else COVERED_BY[self.standing]

    @property
    def settled(self) -> bool:
        """Whether nothing is left to show of it."""
        shown = self.state in (RecordState.PASSED, RecordState.NOT_NEEDED)
        return shown or (self.standing is Standing.TESTED and self.state is RecordState.OPEN)


def recorded_state(id: str, results: RecordedTests, sha256: str) -> RecordState:
    """Return what the user's file says about an id.

    Parameters
    ----------
    id : str
        Of an assumption, or of a step to the robot.
    results : RecordedTests
        Of that file.
    sha256 : str
        Hash of the spec; a result that was found with another one does not count.
    """
    test = results.by_id.get(id)
    if test is None:
        return RecordState.OPEN
    # A failure is told, whichever text of the spec it was found with.
    if not test.passed:
        return RecordState.FAILED
    return RecordState.PASSED if results.spec == sha256 else RecordState.OTHER_SPEC


def register_rows(result: Result, results: RecordedTests) -> tuple[RegisterRow, ...]:
    """Return the register of what was proved, in the order of the certificate.

    Sentences of one id make one row: a test covers all of them.

    Parameters
    ----------
    result : Result
        Of the certification.
    results : RecordedTests
        What users found.
    """
    design = None if result.designed is None else result.designed.spec
    granted = result.certification.granted
    entries = register_of(granted, design)
    grouped: dict[str, list[Entry]] = {}
    for id, entry in zip(ids_of(granted), entries, strict=True):
        grouped.setdefault(id, []).append(entry)
    sha256 = result.loaded.sha256
    return tuple(_row(id, found, results, sha256) for id, found in grouped.items())


def ids_of(granted: Iterable[str]) -> Iterator[str]:
    """Yield the id of each assumption that was assembled from a spec."""
    for statement in granted:
        assert isinstance(statement, Assumption), "assembled from its spec"
        yield statement.id


def _row(id: str, found: list[Entry], results: RecordedTests, sha256: str) -> RegisterRow:
    first, state = found[0], recorded_state(id, results, sha256)
    if state is RecordState.OPEN and first.kind.test == _NO_TEST:
        state = RecordState.NOT_NEEDED
    return RegisterRow(
        id,
        first.kind,
        tuple(entry.statement for entry in found),
        tuple(dict.fromkeys(entry.bound for entry in found)),
        first.standing,
        state,
        results.by_id.get(id),
    )
