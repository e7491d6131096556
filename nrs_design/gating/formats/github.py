"""For GitHub Actions: workflow commands that become annotations of the pull request."""

from __future__ import annotations

from nrs_design.gating.obligations import Caution, GateOutcome, Obligation
from nrs_design.gating.paths import from_here
from nrs_design.printable import printable

# GitHub shows no more than ten annotations of each type per step, whichever come first.
MAX_ANNOTATIONS = 10


def to_github(outcome: GateOutcome) -> str:
    """Return one ``::error`` command per failure, worst first, and a notice if there are more."""
    lines = [_annotation(item) for item in outcome.broken[:MAX_ANNOTATIONS]]
    more = len(outcome.broken) - len(lines)
    if more > 0:
        lines.append(f"::notice title=nrs-design::{more} more not shown; see the log of this step")
    cautions = [item for spec in outcome.specs for item in spec.cautions]
    if outcome.changes is not None:
        cautions += outcome.changes.others
    lines += [_warning(item) for item in cautions[:MAX_ANNOTATIONS]]
    if len(cautions) > MAX_ANNOTATIONS:
        more = len(cautions) - MAX_ANNOTATIONS
        lines.append(f"::notice title=nrs-design::{more} more warnings; see the log of this step")
    return "".join(f"{line}\n" for line in lines)


def _annotation(item: Obligation) -> str:
    properties = {
        "file": from_here(item.path),
        "line": item.line or 1,
        "col": item.column or 1,
        "title": item.rule.id,
    }
    listed = ",".join(f"{key}={_property(str(value))}" for key, value in properties.items())
    return f"::error {listed}::{_data(f'{item.rule.title}: {item.status}. {item.message}')}"


def _warning(item: Caution) -> str:
    place = f"file={_property(from_here(item.path))},line={item.line},col={item.column}"
    return f"::warning {place},title=nrs-design::{_data(item.message)}"


def _data(text: str) -> str:
    return printable(text).replace("%", "%25")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
