"""The end of the report: assumptions as a register, rungs tried, how to check again, the spec."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nrs_design.certificates.catalogue import (
    AssumptionKind,
    Standing,
    bound_of,
    catalogue_kind,
    sentence,
)
from nrs_design.pipeline.certification import Result
from nrs_design.proof.assumption import Assumption
from nrs_design.reporting.document import Bullets, Listing, Paragraph, Section, Table
from nrs_design.reporting.sections.places import linked, locate_assumption
from nrs_design.reporting.sections.titles import ASSUMPTIONS, RECHECK, RUNGS, SPEC
from nrs_design.search.certification import Certification
from nrs_design.spec import InteractionDesignSpec, LoadedSpec

if TYPE_CHECKING:
    from nrs_design.spec import Spec

# A longer spec is left to its file.
_LINES = 1500
_STANDINGS = (
    "Tested: the spec names measured records that it was identified from, without doubts. Argued: "
    "it follows from the construction of the controller. Open: neither tested nor argued; test it "
    "on the robot. The statements are those of the certificate, word for word."
)


def assumptions_section(result: Result) -> Section:
    """Return the table of assumptions with their tests."""
    rows = tuple(
        (
            e.kind.name,
            e.statement,
            linked(result.loaded, e.bound, *locate_assumption(e.kind)),
            e.kind.breaks,
            e.kind.test,
            str(e.standing),
        )
        for e in register_of(result.certification.granted, result.loaded.spec)
    )
    columns = ("Assumption", "Statement", "Bound", "If it is false", "Test", "State")
    table = Table("What is taken for granted", columns, rows)
    return Section(ASSUMPTIONS, (Paragraph(_STANDINGS), table))


def spec_section(loaded: LoadedSpec) -> Section:
    """Show the text of the spec, line by line."""
    lines = tuple(loaded.text.splitlines())
    text = f"{loaded.path.name}, as it was read; linked numbers above lead to their lines."
    if len(lines) > _LINES:
        text += f" The first {_LINES} of {len(lines)} lines."
    return Section(SPEC, (Paragraph(text), Listing("Text of the spec", lines[:_LINES])))


def rungs_section(certification: Certification) -> Section:
    """List every rung of the search with its outcome."""
    rows = tuple((attempt.step, attempt.outcome) for attempt in certification.attempts)
    return Section(RUNGS, (Table("In the order tried", ("Rung", "Outcome"), rows),))


def recheck_section(result: Result) -> Section:
    """Tell how to check the certificate again without trusting this report."""
    name, spec = result.loaded.spec.name, result.loaded.path.name
    if result.certificate is None:
        text = (
            "There is no certificate to check. After a change of the spec, run nrs-design "
            f"certify-switching {spec} again."
        )
        return Section(RECHECK, (Paragraph(text),))
    return Section(
        RECHECK,
        (
            Paragraph("This page is no proof; the certificate is. To check it again, run:"),
            Bullets("", (f"nrs-design verify {name}.cert.json {spec}",)),
            Paragraph(
                "This decides everything in exact arithmetic for the modes in the certificate, and "
                "compares them with those of the spec; it runs no solver and uses no number of "
                "this page. The id of the certificate and the hash of the spec must be those at "
                "the head of this report. "
                f"The certificate is the file that nrs-design certify-switching {spec} writes."
            ),
        ),
    )


@dataclass(frozen=True, slots=True)
class Entry:
    """One assumption of a certificate."""

    statement: str  # In words
    kind: AssumptionKind  # Consequence of a violation, and test
    bound: str  # Within what it must hold
    # Tested by records that the spec names, argued from how the product is made, or open.
    standing: Standing


def register_of(assumptions: Iterable[Assumption], spec: Spec | None = None) -> tuple[Entry, ...]:
    """Return the register of assumptions, in order.

    Motor and environments count as tested where the spec names measured records that they were
    identified from, and no doubt.
    """
    tested = frozenset(_tested(spec)) if isinstance(spec, InteractionDesignSpec) else frozenset()
    kinds = ((assumption, catalogue_kind(assumption)) for assumption in assumptions)
    return tuple(
        Entry(
            sentence(assumption),
            kind,
            bound_of(assumption),
            Standing.TESTED if kind.id in tested else kind.standing,
        )
        for assumption, kind in kinds
    )


def _tested(spec: InteractionDesignSpec) -> Iterator[str]:
    measured = {
        key_path[-1]
        for key_path, item in spec.identified.items()
        if item.provenance
        and all(source.data == "measured" for source in item.provenance)
        and not item.doubts
    }
    if "actuator" in measured:
        yield from ("motor", "nominal-motor")
    if spec.touched and measured.issuperset(spec.touched):
        yield "tissue"
