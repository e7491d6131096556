"""Errors with message, place and remedy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Self


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing that is wrong with a file."""

    message: str  # Error, and expected value
    # line, column: position from 1; None if unknown.
    line: int | None = None
    column: int | None = None
    remedy: str | None = None  # Advice


class NrsDesignError(Exception):
    """Base of every error that a user can cause and mend; line and column count from 1.

    `at` is what is to blame in a spec, such as ``("controllers", "insertion")``; where the file is
    known, line and column are found by it.
    """

    rule = "NRS000"

    def __init__(
        self,
        message: str,
        *,
        path: Path | None = None,
        line: int | None = None,
        column: int | None = None,
        remedy: str | None = None,
        at: tuple[str | int, ...] = (),
    ) -> None:
        super().__init__(message)
        self.message = message
        self.path = path
        self.line = line
        self.column = column
        self.remedy = remedy
        self.at = at

    @property
    def location(self) -> str:
        """The place as ``file:line:column``, as far as it is known."""
        parts = [str(self.path)] if self.path is not None else []
        parts += [str(number) for number in (self.line, self.column) if number is not None]
        return ":".join(parts)

    @property
    def faults(self) -> tuple[Fault, ...]:
        """Everything that is wrong, in file order."""
        return (Fault(self.message, self.line, self.column, self.remedy),)

    @property
    def count_text(self) -> str:
        """Number of further faults, such as ``; 2 more faults in this file``."""
        count = len(self.faults) - 1
        return f"; {count} more fault{'s' * (count > 1)} in this file" if count else ""

    def __str__(self) -> str:
        """One line: place, fault and remedy of the first, and how many more there are."""
        text = f"{self.location}: {self.message}" if self.location else self.message
        return (f"{text} ({self.remedy})" if self.remedy else text) + self.count_text


class SpecError(NrsDesignError):
    """A spec that cannot be read or does not say what it must.

    Message, place and remedy are those of the first fault; ``faults`` holds them all.
    """

    rule = "NRS001"
    _later_faults: tuple[Fault, ...] = ()

    @classmethod
    def combine(cls, faults: Sequence[Fault], path: Path | None) -> Self:
        """Make one error of all the faults of a file, of which there is at least one."""
        first, *others = sorted(faults, key=lambda fault: (fault.line or 0, fault.column or 0))
        error = cls(
            first.message,
            path=path,
            line=first.line,
            column=first.column,
            remedy=first.remedy,
        )
        error._later_faults = tuple(others)
        return error

    @property
    def faults(self) -> tuple[Fault, ...]:
        """Everything that is wrong, in file order."""
        return (*super().faults, *self._later_faults)


class DesignError(NrsDesignError):
    """A design problem that has no answer within its bounds."""

    rule = "NRS002"


class AssemblyError(NrsDesignError):
    """Modes that do not make one switched system."""

    rule = "NRS003"


class CertificateError(NrsDesignError):
    """A certificate that is malformed, or does not belong to the spec it is held against."""

    rule = "NRS004"


class OutputError(NrsDesignError):
    """A result that cannot be written to the requested path."""

    rule = "NRS005"


class ClockError(NrsDesignError):
    """Work that the watchdog timer stopped before the end of its budget, without a decision."""

    rule = "NRS008"


DISAGREE = "the integer check and flint disagree about the same certificate"


class InternalError(Exception):
    """Two independent computations disagree: a defect of this program, never a verdict."""
