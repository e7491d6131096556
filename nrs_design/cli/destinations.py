"""Where results go: into a spec, onto a page, to stdout."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.errors import error_summary, print_error
from nrs_design.cli.printing import note, print_json, progress
from nrs_design.errors import NrsDesignError

if TYPE_CHECKING:
    from datetime import datetime

    from nrs_design.reporting import Report
    from nrs_design.spec import LoadedSpec


@dataclass(frozen=True, slots=True)
class Destinations:
    """Where a result goes: into a spec, onto a page, to stdout."""

    spec: LoadedSpec | None  # What it is merged into
    report: Path | None  # The page: ends in .html or .pdf
    date: datetime | None  # What the user wants to read as the date of the page
    # as_json, quiet: print JSON instead of text; print no text.
    as_json: bool
    quiet: bool

    @classmethod
    def checked(
        cls,
        write: Path | None,
        report: Path | None,
        date: datetime | None,
        *,
        as_json: bool,
        quiet: bool,
    ) -> Self:
        """Refuse what cannot be written, before the work is done.

        Parameters
        ----------
        write : Path or None
            A spec.
        report, date, as_json, quiet
            As for the class.

        Raises
        ------
        OutputError
            If the page is of no type that can be written, or something else stands in its place.
        SpecError
            If there is something wrong with the spec.
        """
        from nrs_design.output import check_place, page_kind
        from nrs_design.spec import read_spec

        if report is not None:
            check_place(report, page_kind(report))
        if write is None:
            return cls(None, report, date, as_json, quiet)
        spec = read_spec(write)
        check_place(write)
        return cls(spec, report, date, as_json, quiet)

    def deliver(
        self,
        command: str,
        *,
        summary: Callable[[], dict[str, Any]],
        show: Callable[[], None],
        page: Callable[[], Report],
        merge: Callable[[LoadedSpec], str] | None = None,
        caveats: Iterable[str] = (),
        slips: Sequence[str] = (),
    ) -> None:
        """Write a result to where it is wanted, and print it; also what a spec refuses to take.

        Parameters
        ----------
        command : str
            As the envelope of JSON names it.
        summary, show : callable
            Returns the content of JSON; prints the text.
        page : callable
            Returns the page.
        merge : callable, optional
            Returns the spec with the result in it.
        caveats : iterable of str
            What is doubtful about values that are merged.
        slips : sequence of str
            What of it says that the data are likely read in another unit or sign: the result is
            then no success, and the exit code says so.
        """
        refused, merged = None, None
        if merge is not None and self.spec is not None:
            try:
                merged = merge(self.spec)
            except NrsDesignError as error:
                # What was found is printed all the same: it took its time.
                refused = error
        if self.report is not None:
            with progress("figures", quiet=self.quiet):
                _write_page(self.report, page(), self.date)
        if self.spec is not None and merged is not None:
            # A proof will rest on these values: no option silences this.
            for caveat in caveats:
                note(f"warning: {caveat}")
            _write_spec(self.spec, merged, quiet=self.quiet)
        if self.as_json:
            not_written = None if refused is None else error_summary(refused)
            written = {} if self.spec is None else {"not_written": not_written}
            print_json(command, summary() | written)
        elif not self.quiet:
            show()
        if self.report is not None:
            note(f"page written to {self.report}", quiet=self.quiet)
        if refused is not None:
            print_error(refused)
            raise typer.Exit(exit_codes.USAGE)
        if slips:
            for slip in slips if merged is None else ():
                note(f"warning: {slip}")
            raise typer.Exit(exit_codes.INCONCLUSIVE)


def _write_page(path: Path, report: Report, date: datetime | None) -> None:
    from nrs_design.output import PDF, page_kind, write_output
    from nrs_design.reporting import render_html, render_pdf

    report, kind = replace(report, date=date.date() if date else None), page_kind(path)
    content = render_pdf(report) if kind is PDF else render_html(report)
    write_output(path, content, replaces=kind)


def _write_spec(spec: LoadedSpec, text: str, *, quiet: bool) -> None:
    from nrs_design.output import write_output
    from nrs_design.spec.changes import spec_changes

    changed, lost = spec_changes(spec, text)
    write_output(spec.path, text)
    for line in changed:
        note(f"changed: {line}", quiet=quiet)
    # What the user wrote, and is gone, no option silences.
    for line in lost:
        note(f"warning: no longer there: {line}")
    note(f"merged into {spec.path}; run nrs-design gate {spec.path} to prove it", quiet=quiet)
