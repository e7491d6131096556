"""What CONTRIBUTING.md promises of additions: how few files know of a thing."""

import ast
import re
from collections.abc import Iterable, Iterator
from functools import cache
from typing import get_args

import pytest

from nrs_design.controllers.laws import LAWS as CONTROL
from nrs_design.models.axis import COMMAND_UNITS
from nrs_design.models.contact import LAWS as CONTACT
from nrs_design.models.contact import LINEAR_LAWS
from nrs_design.proof.evidence import KINDS as EVIDENCE
from nrs_design.spec.load import SPEC_KINDS
from nrs_design.spec.threshold_logic import ThresholdLogicSpec
from tests.package import FILES, names_in, nodes_of
from tests.support import ROOT
from tests.tables import rows


def named_paths(page: str) -> set[str]:
    """Paths of the package that a page names; ``<law>`` stands for any file there."""
    text = (ROOT / page).read_text(encoding="utf-8")
    return set(re.findall(r"`((?:nrs_design|tests|docs)/[\w/.<>-]*)`", text))


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "docs/architecture.md"])
def test_what_the_pages_name_is_there(page):
    patterns = {path: re.sub("<[a-z]+>", "*", path) for path in named_paths(page)}
    assert patterns
    assert [path for path, pattern in patterns.items() if not list(ROOT.glob(pattern))] == []


def test_adding_is_cheap():
    """The table is a promise: at most so many files for each kind of thing."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| an? ([a-z ]+) \| (.*) \|$", text, re.MULTILINE))
    counts = {what: row.count("`nrs_design/") for what, row in rows.items()}
    most = {
        "controller law": 2,
        "environment law": 2,
        "shape of a graph": 2,
        "figure": 2,
        "export format": 1,
    }
    assert {what: counts[what] for what in most} == most
    assert len(re.findall(r"^\| `nrs_design/\S+` \|", text, re.MULTILINE)) == 5


# Who holds a law, or a kind of something, calls it so; a unit of command is one, too.
HELD = {"type", "model", "linear_model", "kind", "law", "command"}
# A file of no kind that is known begins with nothing.
ALLOWED = {
    # Margins are polynomials that are affine in the parameters of these two contacts alone.
    ("nrs_design.design.proved_margins", "Elastic"),
    ("nrs_design.design.proved_margins", "KelvinVoigt"),
    # The library for Coq has theorems about one kind of evidence.
    ("nrs_design.coq.export", "FormsOnGraph"),
}


@cache
def law_names() -> frozenset[str]:
    """Names of laws of control and contact, of motors' commands, of logic, specs and evidence."""
    logic = get_args(ThresholdLogicSpec.model_fields["type"].annotation)
    return frozenset({*CONTROL, *CONTACT, *LINEAR_LAWS, *COMMAND_UNITS, *logic, *EVIDENCE}) | {
        *SPEC_KINDS
    }


def held(node: ast.AST) -> bool:
    """Whether an expression is what something is called: ``spec.model``, ``str(law.name)``."""
    match node:
        case ast.Call(func=ast.Name("str"), args=[inner]):
            return held(inner)
        case ast.Attribute(value=inner, attr="name" | "__name__"):
            return held(inner)
        case ast.Call(func=ast.Name("type"), args=[inner]):
            return held(inner)
    return getattr(node, "attr", getattr(node, "id", None)) in HELD


def told(node: ast.AST, names: frozenset[str]) -> set[str]:
    said = {p.value for p in ast.walk(node) if isinstance(p, ast.Constant)}
    parts = {getattr(p, "id", getattr(p, "attr", None)) for p in ast.walk(node)}
    return {part for part in said | parts if isinstance(part, str)} & names


def law_questions(tree: ast.AST, classes: frozenset[str]) -> Iterator[str]:
    """What a file asks about a law, or about what a spec says of it: its class, or its name."""
    names = law_names()
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name("isinstance" | "issubclass"), args=[_, asked]):
                yield from told(asked, classes)
            case ast.MatchClass(cls=asked):
                yield from {ast.unparse(asked).rpartition(".")[2]} & classes
            case ast.Compare(left=left, comparators=others):
                sides = [left, *others]
                if any(map(held, sides)):
                    yield from set().union(*(told(side, names | classes) for side in sides))
                elif all(isinstance(op, ast.Is | ast.IsNot) for op in node.ops):
                    yield from {getattr(side, "id", None) for side in sides} & classes
            case ast.Match(subject=subject, cases=cases) if held(subject):
                for part in cases:
                    yield from told(part.pattern, names)
            case ast.Call(func=ast.Attribute(value=owner, attr=asked)) if held(owner) and asked in {
                "startswith",
                "endswith",
                "removeprefix",
                "partition",
            }:
                yield from {p.value for a in node.args for p in ast.walk(a) if is_text(p)}
            case ast.Call(func=ast.Attribute(attr="get"), args=[key, _]) if held(key):
                yield "get"


def is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def law_classes() -> frozenset[str]:
    specs = {name for name in names_in(FILES["nrs_design.spec.controllers"]) if "Spec" in name}
    specs |= {name for name in names_in(FILES["nrs_design.spec.environment"]) if "Spec" in name}
    specs |= {"ThresholdLogicSpec"}
    laws = {law.__name__ for law in (*CONTROL.values(), *CONTACT.values(), *LINEAR_LAWS.values())}
    others = {"SpecModel", "ProvenanceSpec", "GainSpec", "GoalsSpec", "AbstractEnvironmentSpec"}
    return frozenset(specs - others | laws | {*EVIDENCE.values()})


def is_union(node: ast.AST) -> bool:
    match node:
        case ast.Name() | ast.Attribute():
            return True
        case ast.BinOp(left=left, op=ast.BitOr(), right=right):
            return is_union(left) and is_union(right)
    return isinstance(node, ast.Tuple) and bool(node.elts) and all(map(is_union, node.elts))


def with_unions(classes: frozenset[str], files: Iterable[Iterable[ast.AST]]) -> frozenset[str]:
    """Classes, and all that unions and tuples of them are assigned to."""
    assigned = [
        node
        for nodes in files
        for node in nodes
        if isinstance(node, ast.Assign) and is_union(node.value)
    ]
    known, before = classes, frozenset[str]()
    while known > before:
        before = known
        for node in assigned:
            if told(node.value, known):
                known |= {t.id for t in node.targets if isinstance(t, ast.Name)}
    return known


@pytest.mark.parametrize(("text", "count"), rows(__file__, "test_what_counts_as_a_question"))
def test_what_counts_as_a_question(text, count):
    tree = ast.parse(text)
    classes = with_unions(law_classes(), [ast.walk(tree)])
    assert len(list(law_questions(tree, classes))) == count


@cache
def questions() -> frozenset[tuple[str, str]]:
    classes = with_unions(law_classes(), map(nodes_of, FILES.values()))
    return frozenset(
        (name, asked)
        for name, path in FILES.items()
        for asked in law_questions(nodes_of(path)[0], classes)
    )


def test_nobody_asks_which_law_it_is():
    """Laws, what a spec says of them, and kinds of evidence are told apart by tables."""
    assert {(name, asked) for name, asked in questions() if asked not in SPEC_KINDS} == ALLOWED
