"""Outputs of a result in addition to stdout: a spec and a page."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Self

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer
from nrs_design.cli.errors import error_summary, print_error
from nrs_design.cli.printing import detail, insist, note, progress, say, wants_details
from nrs_design.cli.tables import print_table
from nrs_design.errors import NrsDesignError

if TYPE_CHECKING:
    from datetime import datetime

    from nrs_design.identification.reporting.view import FindingView
    from nrs_design.identification.spec_document import Merged
    from nrs_design.spec import LoadedSpec


@dataclass(frozen=True, slots=True)
class Destinations:
    """Spec and page that a result is written to."""

    spec: LoadedSpec | None  # The spec that takes the result
    report: Path | None  # The page: ends in .html
    date: datetime | None  # Date on the page

    @classmethod
    def checked(cls, write: Path | None, report: Path | None, date: datetime | None) -> Self:
        """Refuse what cannot be written, before the work is done; `write` is a spec."""
        from nrs_design.errors import SpecError
        from nrs_design.output import PAGE, check_html, check_place
        from nrs_design.spec import read_spec
        from nrs_design.spec.task_space import file_of

        if report is not None:
            check_html(report)
            check_place(report, PAGE)
        spec = None
        if write is not None:
            spec = read_spec(write)
            if file_of(write) != write:
                raise SpecError(
                    "the file holds several axes, and --write merges into specs of one axis only",
                    path=write,
                    remedy="identify without --write, and copy what is found",
                )
            check_place(write)
        return cls(spec, report, date)

    def deliver(self, view: FindingView, merge: Callable[[LoadedSpec], Merged]) -> Answer:
        """Write a result to spec and page; return the answer, with the refusal of the spec.

        `merge` returns the spec with the result in it, and its doubts, on which the gate fails.
        They replace the doubts of the result, and make it inconclusive.
        """
        spec, doubts = self.spec, view.result.doubts
        refused = merged = None
        if spec is not None:
            try:
                merged = merge(spec)
            except NrsDesignError as error:
                # The result is printed nevertheless: its computation took time.
                refused = error
                print_error(error)
        if self.report is not None:
            from nrs_design.output import PAGE, write_output
            from nrs_design.reporting import render_html

            with progress("figures"):
                day = self.date.date() if self.date else None
                write_output(
                    self.report, render_html(replace(view.page(), date=day)), replaces=PAGE
                )
            note(f"page written to {self.report}")
        if refused is None:
            # No option silences this.
            for doubt in doubts if merged is None else merged.doubts:
                insist(f"warning: {doubt}")
        code = exit_codes.INCONCLUSIVE if doubts else exit_codes.PROVED
        spec_facts = {} if spec is None else {"not_written": refused and error_summary(refused)}
        if refused is not None:
            code = exit_codes.USAGE
        elif spec is not None and merged is not None:
            _write_spec(spec, merged)
            code = exit_codes.INCONCLUSIVE if merged.fails_gate else code
        return Answer(lambda: view.document | spec_facts, lambda: _show(view), code)


def _show(view: FindingView) -> None:
    from nrs_design.identification.reporting.view import SYNTHETIC, is_synthetic

    if is_synthetic(view.result.sources):
        say(SYNTHETIC)
    if view.fits is not None and wants_details():
        # The table of the page, without its caption.
        print_table("", view.fits.columns, view.fits.rows)
    for line in view.lines:
        say(line)
    for line in view.details:
        detail(line)
    for remark in view.result.remarks:
        say(remark)
    for doubt in view.result.doubts:
        say(f"doubt: {doubt}")


def _write_spec(spec: LoadedSpec, merged: Merged) -> None:
    from nrs_design.identification.spec_document import spec_changes
    from nrs_design.output import write_output

    changed, removals = spec_changes(spec, merged.text)
    write_output(spec.path, merged.text)
    for line in changed:
        note(f"changed: {line}")
    # What the user wrote, and is gone, no option silences.
    for line in removals:
        insist(f"warning: no longer there: {line}")
    then = f"run nrs-design gate {spec.path} to prove it"
    if merged.fails_gate:
        then = "the gate fails on its doubts until accept_doubt says why the range is used"
    note(f"merged into {spec.path}; {then}")
