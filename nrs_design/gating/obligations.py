"""Results of the gate: obligations by spec, each with a status and a place in the file."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path, PurePath
from typing import Any
from urllib.parse import quote

from nrs_design.errors import ClockError, NrsDesignError
from nrs_design.gating.rules import INTERNAL, MODE_STABLE, RULES, Rule
from nrs_design.proof.text import counted


def is_utf8(path: PurePath) -> bool:
    """Tell whether a file name is valid UTF-8, so that JSON and XML can hold it."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        return False
    return True


def relative_path(path: Path) -> str:
    """Return a path relative to the working folder, with forward slashes.

    CI systems run a step in the root of the repository and resolve names from there.
    """
    relative = Path(os.path.relpath(path)).as_posix()
    return relative.encode(errors="surrogateescape").decode(errors="backslashreplace")


def relative_uri(path: Path) -> str:
    """Return a path relative to the working folder as a percent-encoded URI reference."""
    return quote(os.fsencode(Path(os.path.relpath(path)).as_posix()))


class Status(StrEnum):
    """How an obligation ended; see `nrs_design.gating.rules.WORDS`.

    What is decided in exact arithmetic is proved or refuted. Design goals, which are computed in
    floating point, and agreement between files are met or missed.
    """

    PROVED = "proved"
    MET = "met"
    INCONCLUSIVE = "inconclusive"
    MISSED = "missed"
    REFUTED = "refuted"
    ERROR = "error"


@dataclass(frozen=True, slots=True)
class Obligation:
    """One thing that must hold for one spec."""

    rule: Rule  # The rule that must hold
    path: Path  # The spec, as it was named
    subject: str  # Mode, controller, system or file that the rule is about
    status: Status  # Result of the check
    message: str  # Text of one line
    # line, column: place in the spec, counted from 1, as far as it is known.
    line: int | None = None
    column: int | None = None

    @property
    def fulfilled(self) -> bool:
        """Whether the gate passes with this status."""
        return self.status in (Status.PROVED, Status.MET)

    @property
    def severity(self) -> int:
        """0 if fulfilled; then inconclusive, missed or refuted, error, internal error."""
        return 4 if self.rule is INTERNAL else _SEVERITY[self.status]


@dataclass(frozen=True, slots=True)
class Caution:
    """Something doubtful that does not keep the gate from passing."""

    path: Path  # The spec, as it was named
    message: str  # Text of one line
    # line, column: place in the spec, counted from 1.
    line: int
    column: int
    beyond: float = 0.0  # Ratio of a value of the design to its limit; 0 without a limit
    at: tuple[str | int, ...] = ()  # Keys that lead there, as far as they are known


_SEVERITY = {
    Status.PROVED: 0,
    Status.MET: 0,
    Status.INCONCLUSIVE: 1,
    Status.MISSED: 2,
    Status.REFUTED: 2,
    Status.ERROR: 3,
}


@dataclass(frozen=True, slots=True)
class SpecOutcome:
    """Everything that was found about one spec."""

    path: Path  # The spec, as it was named
    obligations: tuple[Obligation, ...]  # At least one
    sha256: str | None = None  # Hash of the spec, if it could be read
    # verdict, common_quadratic: of the certification; None if there was none.
    verdict: str | None = None
    common_quadratic: str | None = None
    # The contact that the refutation is about, where the loss of contact stays undecided.
    refuted_in: str | None = None
    rate: str | None = None  # Certified rate with six digits, rounded to its safe side
    # ``alpha`` (1/s, continuous time) or ``rho`` (per step, discrete time).
    rate_name: str | None = None
    modes: int | None = None  # Number of modes
    certificate: Path | None = None  # Its file
    certificate_id: str | None = None  # Its id
    # What the obligations are about: designed gains (float32, as exact decimals) by controller;
    # empty for given matrices.
    gains: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    # Units of these gains, by controller.
    units: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    # False for a valid spec without a claim about switching, such as a robot: without verdict and
    # lock entry.
    certifiable: bool = True
    cautions: tuple[Caution, ...] = ()  # What is doubtful, and breaks no obligation
    # As `nrs_design.certificates.bounds.bounds_summary` gives them.
    bounds: Sequence[Mapping[str, Any]] = ()


@dataclass(frozen=True, slots=True)
class BaseChanges:
    """Changes against the specs of a base."""

    base: Path  # Folder of the base
    weaker: int  # Number of obligations that it breaks
    others: tuple[Caution, ...]  # Stronger requirements, neutral changes, versions


@dataclass(frozen=True, slots=True)
class GateOutcome:
    """Result of one run of the gate."""

    specs: tuple[SpecOutcome, ...]  # In the order of their paths
    notes: tuple[str, ...] = ()  # Remarks on the run
    changes: BaseChanges | None = None  # Changes against a base; None without --against

    @property
    def cautions(self) -> tuple[Caution, ...]:
        """What is doubtful, worst first, else in the order of the specs."""
        cautions = (item for spec in self.specs for item in spec.cautions)
        return tuple(sorted(cautions, key=lambda item: -item.beyond))

    @property
    def broken(self) -> tuple[Obligation, ...]:
        """Obligations that are not fulfilled, worst first, else in their order."""
        every = (item for spec in self.specs for item in spec.obligations)
        return tuple(
            sorted((item for item in every if not item.fulfilled), key=lambda item: -item.severity)
        )

    @property
    def findings(self) -> tuple[Obligation, ...]:
        """Broken obligations; equal failures of the modes of one controller are merged.

        The modes of one controller have the same line of the spec.
        """
        alike: dict[Hashable, list[Obligation]] = {}
        for number, item in enumerate(self.broken):
            is_mode = item.rule is MODE_STABLE and item.line is not None
            key = (item.path, item.line, item.status) if is_mode else number
            alike.setdefault(key, []).append(item)
        return tuple(_add_count(first, len(others)) for first, *others in alike.values())

    @property
    def severity(self) -> int:
        """That of the worst obligation."""
        return max((item.severity for item in self.broken), default=0)

    def with_note(self, note: str) -> GateOutcome:
        """Return the same outcome with one more note."""
        return replace(self, notes=(*self.notes, note))


def failed(path: Path, error: Exception, sha256: str | None = None) -> SpecOutcome:
    """Return the outcome of a spec that an error stopped; an unforeseen one is a defect."""
    if not isinstance(error, NrsDesignError):
        message = _one_line(f"{type(error).__name__}: {error}")
        defect = Obligation(INTERNAL, path, "nrs-design", Status.ERROR, message)
        return SpecOutcome(path, (defect,), sha256)
    elsewhere = error.path is not None and error.path != path
    message = f"{error.location}: {error.message}" if elsewhere else error.message
    if error.remedy:
        message += f" ({error.remedy})"
    message = _one_line(message + error.count_text)
    status = Status.INCONCLUSIVE if isinstance(error, ClockError) else Status.ERROR
    place = (None, None) if elsewhere else (error.line, error.column)
    found = Obligation(RULES[error.rule], path, "spec", status, message, *place)
    return SpecOutcome(path, (found,), sha256)


def count_by_verdict(specs: Iterable[SpecOutcome]) -> dict[str, int]:
    """Count specs by verdict, or by the reason for none."""
    empty = {True: "without verdict", False: "with nothing to certify"}
    return Counter(spec.verdict or empty[spec.certifiable] for spec in specs)


def _add_count(first: Obligation, count: int) -> Obligation:
    """Return an obligation whose message counts equal failures of other modes."""
    if not count:
        return first
    modes = counted(count, "more mode")
    return replace(first, message=f"{first.message}; likewise {modes} of its controller (--json)")


def _one_line(text: str) -> str:
    return " ".join(text.split())
