"""What CONTRIBUTING.md promises of additions: how few files know of a thing."""

import ast
import re
from collections.abc import Iterator

import pytest

from nrs_design.controllers.laws import LAWS as CONTROL
from nrs_design.models.contact import LAWS as CONTACT
from tests.package import FILES, PACKAGE, names_in, nodes_of
from tests.support import ROOT


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
    most = {"controller law": 5, "environment law": 4, "figure": 2, "export format": 2}
    assert {what: counts[what] for what in most} == most
    assert len(re.findall(r"^\| `nrs_design/\S+` \|", text, re.MULTILINE)) == 6


@pytest.mark.parametrize(
    ("law", "file", "also"),
    [
        # The target of impedance control is listed, and doubted, by name; its gains are searched,
        # and the loops of all of them follow from a few.
        (
            "Admittance",
            "impedance",
            {"spec/describe.py", "design/doubts.py", "switched/cut_loop.py"},
        ),
        ("ProportionalForce", "force", set()),
        ("PositionControl", "position", set()),
        ("IntegralForce", "integral", set()),
        ("ParallelForce", "parallel", set()),
    ],
)
def test_a_control_law_is_known_to_the_files_of_the_table(law, file, also):
    known = {
        path.relative_to(PACKAGE).as_posix()
        for path in FILES.values()
        if {law, f"{file.capitalize()}ControllerSpec"} & names_in(path)
        and path.parent.name != "reproduction"
    }
    assert known <= also | {
        f"controllers/laws/{file}.py",
        "controllers/laws/__init__.py",
        "spec/controllers.py",
        "spec/__init__.py",
        f"design/laws/{file}.py",
    }


# The target of impedance control is listed by name, and one law is not linear along runs.
KNOWN_QUESTIONS = {
    ("nrs_design.spec.describe", "impedance"),
    ("nrs_design.simulation.build_scenario", "hunt-crossley"),
}


def law_questions(tree: ast.AST, classes: frozenset[str]) -> Iterator[str]:
    """What a file asks about a law, or about what a spec says of it: its class, or its name."""
    names = {*CONTROL, *CONTACT, "hand"}
    for node in ast.walk(tree):
        match node:
            case ast.Call(func=ast.Name("isinstance" | "issubclass"), args=[_, asked]):
                parts = {getattr(p, "id", getattr(p, "attr", None)) for p in ast.walk(asked)}
                yield from parts & classes
            case ast.MatchClass(cls=asked):
                yield from {ast.unparse(asked).rpartition(".")[2]} & classes
            case ast.Compare(left=ast.Attribute(attr="type" | "model"), comparators=[told]):
                said = {p.value for p in ast.walk(told) if isinstance(p, ast.Constant)}
                yield from said & names
            case ast.Match(subject=ast.Attribute(attr="type" | "model"), cases=cases):
                parts = [part for case in cases for part in ast.walk(case.pattern)]
                yield from {p.value for p in parts if isinstance(p, ast.Constant)} & names


def law_classes() -> frozenset[str]:
    specs = {name for name in names_in(FILES["nrs_design.spec.controllers"]) if "Spec" in name}
    specs |= {name for name in names_in(FILES["nrs_design.spec.environment"]) if "Spec" in name}
    laws = {law.__name__ for law in (*CONTROL.values(), *CONTACT.values())}
    others = {"SpecModel", "ProvenanceSpec", "GainSpec", "GoalsSpec"}
    return frozenset(specs - others | laws)


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("isinstance(law, Admittance)", 1),
        ("isinstance(law, laws.Admittance | Maxwell)", 2),
        ("match law:\n  case Admittance(): pass", 1),
        ("spec.type == 'impedance'", 1),
        ("spec.model not in ('elastic', 'maxwell')", 2),
        ("match spec.type:\n  case 'force': pass", 1),
        ("spec.commands == 'velocity'", 0),
        ("LAWS[spec.type]", 0),
    ],
)
def test_what_counts_as_a_question(text, count):
    assert len(list(law_questions(ast.parse(text), law_classes()))) == count


def test_nobody_asks_which_law_it_is():
    """Laws of control and of contact, and what a spec says of them, are told apart by tables."""
    classes = law_classes()
    asked = {
        (name, asked)
        for name, path in FILES.items()
        for asked in law_questions(nodes_of(path)[0], classes)
    }
    assert asked == KNOWN_QUESTIONS


@pytest.mark.parametrize(
    ("law", "file"), [("Maxwell", "maxwell"), ("KelvinBoltzmann", "kelvin_boltzmann")]
)
def test_a_linear_law_of_contact_is_known_to_the_files_of_the_table(law, file):
    """Others take it from the tables; only the numbers of the dissertation ask for one by name."""
    known = {
        path.relative_to(PACKAGE).as_posix()
        for path in FILES.values()
        if {law, f"{law}Spec"} & names_in(path) and path.parent.name != "reproduction"
    }
    assert known <= {
        f"models/contact/{file}.py",
        "models/contact/__init__.py",
        "spec/environment.py",
        "identification/tissue/starts.py",
    }
