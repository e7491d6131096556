"""What users found when they tested: a YAML file with a result for each id."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import NoReturn

from nrs_design.errors import DataError
from nrs_design.proof.text import quoted
from nrs_design.spec import document as tree

PASSED, FAILED = "passed", "failed"
NEEDED, OPTIONAL = ("result", "date", "reference"), ("by",)
_SHA256 = re.compile("[0-9a-f]{64}")
_EXAMPLE = "write `ID: {result: passed, date: 2026-01-31, reference: report 17}` below `results:`"


@dataclass(frozen=True, slots=True)
class RecordedTest:
    """One test as its user recorded it; nothing here was seen by this program."""

    passed: bool
    date: str  # As YYYY-MM-DD
    reference: str  # Where the record of the test is
    by: str  # Who tested; empty if nobody is named

    @property
    def said(self) -> str:
        """The result in a few words."""
        by = f", by {self.by}" if self.by else ""
        return f"{PASSED if self.passed else FAILED}, {self.date}{by}, {self.reference}"


@dataclass(frozen=True, slots=True)
class RecordedTests:
    """The results of a file."""

    spec: str = ""  # Hash of the spec that was tested, in hexadecimal; empty without a file
    by_id: Mapping[str, RecordedTest] = field(default_factory=dict)
    text: str = ""  # The file, as it is


def read_results(path: Path, ids: Collection[str]) -> RecordedTests:
    """Read what users found.

    Parameters
    ----------
    path : Path
        A YAML file: ``spec``, the hash of the spec that was tested, and ``results``, by id.
    ids : collection of str
        All that there are for this spec.

    Raises
    ------
    DataError
        With its line, if the file says something else, or has an id that is none of them.
    SpecError
        If it is no such YAML file at all.
    """
    _, text = tree.read_source(path)
    return _Reader(path).read(tree.parse_document(text, path), ids, text)


@dataclass(frozen=True, slots=True)
class _Reader:
    path: Path

    def read(self, root: tree.Node, ids: Collection[str], text: str) -> RecordedTests:
        top = self.mapping(root, "the file")
        self.expect_keys(top, ("spec", "results"))
        spec = self.text(top.entries["spec"], "spec")
        if not _SHA256.fullmatch(spec):
            remedy = "copy it from results-to-do.yaml in the folder, or from README.md there"
            self.fail(top.entries["spec"].position, "spec is not a SHA-256", remedy)
        results = self.mapping(top.entries["results"], "results")
        return RecordedTests(spec, dict(self.items(results, ids)), text)

    def items(
        self, results: tree.Mapping, ids: Collection[str]
    ) -> Iterator[tuple[str, RecordedTest]]:
        for name, node in results.entries.items():
            if name not in ids:
                remedy = f"the ids of this spec are {', '.join(ids)}"
                self.fail(results.keys[name], f"there is no id {quoted(name)}", remedy)
            yield name, self.test(self.mapping(node, name), name)

    def test(self, item: tree.Mapping, name: str) -> RecordedTest:
        self.expect_keys(item, NEEDED, OPTIONAL)
        said = {key: self.text(node, f"{key} of {name}") for key, node in item.entries.items()}
        if said["result"] not in (PASSED, FAILED):
            at = item.entries["result"].position
            self.fail(at, f"the result is {quoted(said['result'])}", f"write {PASSED} or {FAILED}")
        try:
            day = date.fromisoformat(said["date"]).isoformat()
        except ValueError:
            at = item.entries["date"].position
            self.fail(at, f"{quoted(said['date'])} is no date", "write one such as 2026-01-31")
        return RecordedTest(said["result"] == PASSED, day, said["reference"], said.get("by", ""))

    def expect_keys(
        self, item: tree.Mapping, needed: Collection[str], optional: Collection[str] = ()
    ) -> None:
        for key in item.entries.keys() - {*needed, *optional}:
            self.fail(item.keys[key], f"{quoted(key)} is no key here", _EXAMPLE)
        for key in needed:
            if key not in item.entries:
                self.fail(item.position, f"{key} is missing", _EXAMPLE)

    def mapping(self, node: tree.Node, what: str) -> tree.Mapping:
        if not isinstance(node, tree.Mapping):
            self.fail(node.position, f"{quoted(what)} is no mapping", _EXAMPLE)
        return node

    def text(self, node: tree.Node, what: str) -> str:
        if not isinstance(node, tree.Scalar) or not node.text.strip():
            self.fail(node.position, f"{what} is no text", _EXAMPLE)
        return node.text.strip()

    def fail(self, at: tree.Position, message: str, remedy: str) -> NoReturn:
        raise DataError(message, path=self.path, line=at.line, column=at.column, remedy=remedy)
