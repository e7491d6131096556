"""Record, law and C names of an export: the source of all formats of a program."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.operations import StepLaw
from nrs_design.controllers.shipped import shipped_law
from nrs_design.exporters.c_names import CNames
from nrs_design.exporters.export import Export
from nrs_design.exporters.header import header_lines
from nrs_design.exporters.record import ExportRecord


@dataclass(frozen=True, slots=True)
class Program:
    """A law that a processor runs."""

    record: ExportRecord  # Gains and proof
    law: StepLaw  # Its operations
    names: CNames  # Of its spec

    @property
    def about(self) -> tuple[str, ...]:
        """What every exported file says of itself."""
        return header_lines(self.record)


def program_of(export: Export) -> Program:
    """Return the program of an export.

    A `DesignError` if nothing may be exported, a controller has no program, or names coincide in C.
    """
    record = export.shipped()
    assert export.spec is not None
    assert export.design is not None
    assert record.sample_time is not None
    law = shipped_law(export.spec, export.design, Fraction(record.sample_time.exact))
    names = CNames(record.spec.name)
    names.check(law)
    return Program(record, law, names)
