"""For GitHub Actions: workflow commands that become annotations of the pull request."""

from __future__ import annotations

from nrs_design.gating.obligations import Caution, GateOutcome, Obligation, relative_path
from nrs_design.printable import printable
from nrs_design.spec.task_space import file_of


def format_github(outcome: GateOutcome) -> str:
    """Return one ``::error`` command per failure, worst first, then one for each warning."""
    errors = [
        _annotation("error", i, i.rule.id, f"{i.rule.title}: {i.status}. {i.message}")
        for i in outcome.findings
    ]
    changed = () if outcome.changes is None else outcome.changes.others
    cautions = (*outcome.cautions, *changed)
    warnings = [_annotation("warning", i, "nrs-design", i.message) for i in cautions]
    return "".join(f"{line}\n" for line in (*errors, *warnings))


def _annotation(kind: str, item: Obligation | Caution, title: str, text: str) -> str:
    place = {
        "file": relative_path(file_of(item.path)),
        "line": item.line or 1,
        "col": item.column or 1,
    }
    properties = {**place, "title": title}
    fields = ",".join(f"{key}={_property(str(value))}" for key, value in properties.items())
    return f"::{kind} {fields}::{_data(text)}"


def _data(text: str) -> str:
    return printable(text).replace("%", "%25")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
