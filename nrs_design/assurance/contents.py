"""Every file of a case, as bytes: the same facts give the same bytes."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

from nrs_design.assurance.argument import build_argument
from nrs_design.assurance.build import Build
from nrs_design.assurance.case import Case
from nrs_design.assurance.gsn import GsnElement, render_text
from nrs_design.assurance.gsn_svg import render_svg
from nrs_design.assurance.hazards import TracedHazard
from nrs_design.assurance.pages import (
    form_page,
    hazard_page,
    register_page,
    standards_page,
    start_page,
    tool_page,
)
from nrs_design.assurance.register import RegisterRow
from nrs_design.assurance.sbom import parts_list
from nrs_design.certificates.certificate import dump
from nrs_design.printable import json_text

FACTS, SUMS, PARTS, RESULTS = "evidence.json", "SHA256SUMS", "sbom.cdx.json", "results.yaml"
BUILD = "build.json"
SCHEMA = "nrs-design/evidence-folder/1"
# Git must not change the ends of lines, or no hash is right.
_ATTRIBUTES = b"* -text\n"


def contents_of(case: Case, spec: str, sources: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return all files by their paths in the folder, with forward slashes, in order.

    Parameters
    ----------
    case : Case
        The facts.
    spec : str
        Path of the spec in the folder.
    sources : mapping of str to bytes
        The spec, and the files that it names, by their paths in the folder.
    """
    argument = build_argument(case)
    pages = {
        ".gitattributes": _ATTRIBUTES,
        "README.md": start_page(case).encode(),
        "assumptions.md": register_page(case).encode(),
        "hazards.md": hazard_page(case).encode(),
        "tool.md": tool_page(case).encode(),
        "argument.svg": render_svg(argument).encode(),
        "argument.txt": render_text(argument).encode(),
        "results-to-do.yaml": form_page(case).encode(),
        PARTS: _json(parts_list()),
        f"{case.name}.cert.json": dump(case.certificate, spec).encode(),
        FACTS: _json(case_facts(case, spec, argument)),
        **sources,
        **{f"program/{name}": content for name, content in case.program.items()},
    }
    if case.results.text:
        pages[RESULTS] = case.results.text.encode()
    if case.build is not None:
        pages[BUILD] = case.build.content
    pages["standards.md"] = standards_page(case, pages).encode()
    return {SUMS: sums_of(pages), **dict(sorted(pages.items()))}


def sums_of(files: Mapping[str, bytes]) -> bytes:
    """Return the hashes of files as sha256sum writes them, in the order of their paths."""
    hashes = {path: hashlib.sha256(content).hexdigest() for path, content in files.items()}
    return "".join(f"{hashes[path]}  {path}\n" for path in sorted(files)).encode()


def case_facts(case: Case, spec: str, argument: GsnElement) -> dict[str, Any]:
    """Return the facts of a case for programs.

    Parameters
    ----------
    case : Case
        The facts.
    spec : str
        Path of the spec in the folder.
    argument : GsnElement
        The goal above all others.
    """
    decides = case.decider
    mutation = decides.mutation
    return {
        "schema": SCHEMA,
        "package": {"name": "nrs-design", "version": decides.release},
        "date": case.date or None,
        "spec": {"name": case.name, "sha256": case.spec_sha256, "file": spec},
        "certificate": {"file": f"{case.name}.cert.json", "id": case.certificate_id},
        "claim": case.claim,
        "also": case.also,
        "outside": case.outside,
        "gains": case.gains,
        "obligations": [
            {"rule": o.rule.id, "subject": o.subject, "status": o.status, "message": o.message}
            for o in case.obligations
        ],
        "assumptions": list(map(_assumption_facts, case.register)),
        "steps": {id: state for id, state in case.states.items() if id not in _ids(case)},
        "hazards": list(map(_hazard_facts, case.hazards)),
        "argument": [_element_facts(element) for element in argument.walk()],
        "program": {"files": sorted(case.program), "none_since": case.no_program or None},
        "build": None if case.build is None else _build_facts(case.build),
        "binaries": [
            {"name": file.name, "size": file.size, "sha256": file.sha256} for file in case.binaries
        ],
        "decides": {
            "sha256": decides.sha256,
            "lines": decides.lines,
            "imports": decides.imports,
            "believed_beside": decides.believed,
            "files": {file.path: file.sha256 for file in decides.files},
            "mutants": None
            if mutation is None
            else {
                "mutants": mutation.mutants,
                "killed": mutation.killed,
                "equivalent": mutation.equivalent,
                "unnoticed": mutation.unnoticed,
                "of_these_files": decides.examined,
            },
        },
        "open": case.open,
        "failed": case.failed,
    }


def _build_facts(build: Build) -> dict[str, Any]:
    return {
        "compiler": build.record.compiler.version,
        "compile": build.record.compile,
        "run": build.record.run,
        "result": build.record.result,
        "compiled": dict(build.record.compiled),
        "other_sources": build.others,
        "not_compared": build.record.not_compared,
    }


def _ids(case: Case) -> set[str]:
    return {row.id for row in case.register}


def _assumption_facts(row: RegisterRow) -> dict[str, Any]:
    test = row.test
    return {
        "id": row.id,
        "name": row.kind.name,
        "statements": row.statements,
        "within": row.bounds,
        "breaks": row.kind.breaks,
        "covered_by": row.covered_by,
        "test": row.kind.test,
        "state": row.state,
        "result": None
        if test is None
        else {
            "passed": test.passed,
            "date": test.date,
            "by": test.by or None,
            "reference": test.reference,
        },
    }


def _hazard_facts(traced: TracedHazard) -> dict[str, Any]:
    return {
        "id": traced.hazard.id,
        "name": traced.hazard.name,
        "obligations": [f"{item.rule.id} {item.subject}" for item in traced.obligations],
        "missed": [f"{item.rule.id} {item.subject}" for item in traced.missed],
        "limits": traced.limits,
        "gains": traced.gains,
        "assumptions": [row.id for row in traced.assumptions],
        "monitor": traced.watched,
    }


def _element_facts(element: GsnElement) -> dict[str, Any]:
    return {
        "id": element.id,
        "kind": element.kind,
        "text": element.text,
        "supported_by": [child.id for child in element.supported_by],
        "in_context_of": [child.id for child in element.in_context_of],
        "undeveloped": element.undeveloped,
        "refuted": element.refuted,
    }


def _json(document: dict[str, Any]) -> bytes:
    return (json_text(document) + "\n").encode()
