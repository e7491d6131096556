"""The evidence: for each statement of a certification, what it holds and a run that shows it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from nrs_design.reporting.document import Paragraph, Section
from nrs_design.reporting.evidence import page_of
from nrs_design.reporting.evidence.runs import unbounded_run
from nrs_design.search.certification import Certification

_LINEAR = "Nothing is cut off at a limit in this run, as if no signal ever saturated."


def evidence_sections(certification: Certification) -> Iterator[Section]:
    """Yield a section for every statement, and one with a run."""
    system, evidence = certification.system, certification.evidence
    for statement in certification.statements:
        yield from page_of(system, statement).sections()
    drawn = None if evidence is None else page_of(system, evidence).run
    run = unbounded_run(system) if drawn is None else drawn()
    if system.saturation is not None:
        run = replace(run, blocks=(Paragraph(_LINEAR), *run.blocks))
    yield run
