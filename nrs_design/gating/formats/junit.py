"""For test reporters: JUnit XML, one test case per proof obligation, one suite per spec."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

from nrs_design.gating.obligations import GateOutcome, Obligation, Status, relative_path
from nrs_design.printable import printable


def format_junit(outcome: GateOutcome) -> str:
    """Return the XML document; it has no times, so that equal runs give equal files."""
    obligations = [item for spec in outcome.specs for item in spec.obligations]
    root = ElementTree.Element("testsuites", {"name": "nrs-design", **_counts(obligations)})
    for spec in outcome.specs:
        name = printable(relative_path(spec.path))
        attributes = {"name": name, **_counts(spec.obligations)}
        suite = ElementTree.SubElement(root, "testsuite", attributes)
        for item in spec.obligations:
            _add_case(suite, name, item)
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{body}\n'


def _add_case(suite: ElementTree.Element, file: str, item: Obligation) -> None:
    name = printable(f"{item.rule.id} {item.rule.title}: {item.subject}")
    case = ElementTree.SubElement(suite, "testcase", classname=file, name=name, file=file)
    if item.line is not None:
        case.set("line", str(item.line))
    if item.fulfilled:
        return
    is_error = item.status is Status.ERROR
    failure = ElementTree.SubElement(
        case,
        "error" if is_error else "failure",
        type=item.rule.id if is_error else str(item.status),
        message=printable(item.message),
    )
    failure.text = printable(item.rule.remedy)


def _counts(items: Sequence[Obligation]) -> dict[str, str]:
    broken = [item.status for item in items if not item.fulfilled]
    errors = broken.count(Status.ERROR)
    return {"tests": str(len(items)), "failures": str(len(broken) - errors), "errors": str(errors)}
