"""The house has floors, and imports point downward only; docs/architecture.md lists them."""

import ast
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from nrs_design.controllers.laws import LAWS as CONTROL
from nrs_design.models.contact import LAWS as CONTACT
from tests.support import ROOT

PACKAGE = ROOT / "nrs_design"
# Evidence about a block, or at one value, holds evidence of any kind: the table of them all has its
# reader and its page.
KNOWN_CYCLES = {
    ("nrs_design.proof.evidence", "nrs_design.proof.evidence.block_triangular"),
    ("nrs_design.reporting.kinds", "nrs_design.reporting.kinds.block_triangular"),
    ("nrs_design.reporting.kinds", "nrs_design.reporting.kinds.unstable_value"),
    # The root names for type checkers what it loads when it is asked, and holds the version.
    ("nrs_design.api", "nrs_design"),
}
STAGES = {"models", "design", "switched", "search"}
# What a command may use of a stage: its door, or a module of nouns and words.
DOORS = {
    "nrs_design.models.contact",
    "nrs_design.models.robot",
    "nrs_design.search.certification",
    "nrs_design.search.gradient_settings",
    "nrs_design.search.method",
    "nrs_design.design.measures",
}
# What is found in a stage, and printed or written as it is: for annotations only.
PRINTED = {
    "nrs_design.design.analysis",
    "nrs_design.design.goals",
    "nrs_design.design.sampled_passivity",
    "nrs_design.search.loop_margin",
    "nrs_design.search.method_run",
}


@dataclass(frozen=True)
class Import:
    source: str
    target: str
    line: int
    typing_only: bool


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_name(path): path for path in sorted(PACKAGE.rglob("*.py"))}


@cache
def nodes_of(path: Path) -> tuple[ast.AST, ...]:
    """All that a file says, read once for all questions."""
    return tuple(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))


def targets(node: ast.AST) -> Iterator[str]:
    """Modules that a statement imports, as far down as they are modules."""
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    if isinstance(node, ast.ImportFrom):
        assert node.level == 0
        assert node.module
        for alias in node.names:
            inner = f"{node.module}.{alias.name}"
            yield inner if inner in FILES else node.module


def imports_of(name: str) -> Iterator[Import]:
    for_types = {
        id(inner)
        for node in nodes_of(FILES[name])
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    for node in nodes_of(FILES[name]):
        for target in targets(node):
            yield Import(name, target, node.lineno, id(node) in for_types)


@cache
def imports() -> tuple[Import, ...]:
    return tuple(item for name in FILES for item in imports_of(name))


@cache
def ours() -> tuple[Import, ...]:
    return tuple(item for item in imports() if item.target.split(".")[0] == "nrs_design")


def floor(module: str) -> str:
    return [*module.split("."), "__init__"][1]


def floors() -> list[str]:
    """The floors of docs/architecture.md, ground floor first."""
    text = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ((?:`\w+`,? ?)+) \|", text, re.MULTILINE)
    return [name for row in reversed(rows) for name in reversed(re.findall(r"`(\w+)`", row))]


def test_every_module_has_a_floor():
    assert len(floors()) == len(set(floors()))
    assert set(floors()) == {floor(name) for name in FILES} - {"__init__", "__main__"}


def test_imports_point_downward():
    # The root holds the version, which everyone may quote, and shows the library at the door.
    rank = {"__init__": -1} | {name: height for height, name in enumerate(floors())}
    rank["__main__"] = len(rank)
    up = [
        item
        for item in ours()
        if rank[floor(item.target)] > rank[floor(item.source)] and item.source != "nrs_design"
    ]
    assert not up
    assert {item.target for item in ours() if item.source == "nrs_design"} == {"nrs_design.api"}


def test_no_module_imports_itself_by_way_of_others():
    """Not for annotations, either: whoever reads a module reads those that it names."""
    graph = {name: set() for name in FILES}
    for item in ours():
        if (item.target, item.source) not in KNOWN_CYCLES:
            graph[item.source].add(item.target)
    while ends := {name for name, after in graph.items() if not after} | (
        graph.keys() - set().union(*graph.values())
    ):
        graph = {name: after - ends for name, after in graph.items() if name not in ends}
    assert not graph


def test_the_proof_stands_on_itself():
    below = {
        item.target.split(".")[0]
        for item in imports()
        if floor(item.source) == "proof" and not item.target.startswith("nrs_design.proof.")
    }
    assert below - sys.stdlib_module_names <= {"flint"}


def private_names(path: Path) -> Iterator[str]:
    """Names with one underscore that a test imports, reads or puts something in the place of."""
    for node in nodes_of(path):
        match node:
            case ast.ImportFrom(module=str(module)) if module.startswith("nrs_design"):
                yield from (alias.name for alias in node.names)
            case ast.Attribute(ast.Name(owner), name) if owner not in {"self", "cls"}:
                yield name
            case ast.Call(ast.Attribute(attr="setattr" | "object" | "patch"), arguments):
                texts = (ast.literal_eval(a) for a in arguments if isinstance(a, ast.Constant))
                yield from (text.split(".")[-1] for text in texts if isinstance(text, str))


def test_tests_use_what_is_public():
    known = {"_repr_html_", "_exit"}
    private = [
        (path.name, name)
        for path in sorted((ROOT / "tests").rglob("*.py"))
        for name in private_names(path)
        if re.match(r"_[^_]", name) and name not in known
    ]
    assert not private


@pytest.mark.parametrize("above", ["cli", "gating", "exporters"])
def test_stages_are_known_to_the_pipeline_only(above):
    """A command asks the pipeline; it takes types of a stage, to print them."""
    inside = [
        item
        for item in ours()
        if floor(item.source) == above
        and floor(item.target) in STAGES
        and item.target not in DOORS
        and not (item.typing_only and item.target in PRINTED)
    ]
    assert not inside


def test_a_report_assembles_and_searches_nothing():
    """It shows what the pipeline gives it, and draws the curves of a design."""
    read = {item.target for item in ours() if floor(item.source) == "reporting"}
    assert {name for name in read if floor(name) in ("switched", "search")} == {
        "nrs_design.search.certification",
        "nrs_design.search.gradient_settings",
        "nrs_design.search.loop_margin",
        "nrs_design.search.method_run",
        "nrs_design.switched.assumption",
        "nrs_design.switched.assumption_kinds",
    }


VERBS = {
    ("nrs_design.models.plant", "build_plant"),
    ("nrs_design.design.design", "design_controllers"),
    ("nrs_design.design.analysis", "analyze_design"),
    ("nrs_design.switched.assemble", "assemble"),
    ("nrs_design.switched.assemble", "assemble_matrices"),
    ("nrs_design.search.certify", "certify"),
}


def as_one(name: str) -> str:
    """The modules of the pipeline count as one."""
    return "nrs_design.pipeline" if floor(name) == "pipeline" else name


def test_only_the_pipeline_calls_the_stages():
    """Published matrices are certified as they are, and a re-check builds the plant of its spec.

    The axes of a ROS 2 controller come from no spec, so no other stage is before their proof.
    """
    callers = {
        (as_one(name), verb)
        for name, path in FILES.items()
        for node in nodes_of(path)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
        if (verb := (node.module, alias.name)) in VERBS
    }
    assert {verb for name, verb in callers if name == "nrs_design.pipeline"} == VERBS
    assert {name for name, _ in callers} == {
        "nrs_design.pipeline",
        "nrs_design.switched.assemble",
        "nrs_design.reproduction.switching",
        "nrs_design.ros2.check",
        "nrs_design.ros2.export",
    }


def test_a_class_name_means_one_thing():
    """Whoever reads a name knows the noun, without looking where it was imported from."""
    homes: dict[str, list[str]] = {}
    for name, path in FILES.items():
        for node in ast.iter_child_nodes(nodes_of(path)[0]):
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes.setdefault(node.name, []).append(name)
    assert len(homes) > 500
    assert {name: where for name, where in homes.items() if len(where) > 1} == {}


def uses(name: str, word: str) -> bool:
    """Whether the code of a module uses a name, as a function, an attribute or by importing it."""
    return any(
        word in (getattr(node, "id", None), getattr(node, "attr", None))
        or (isinstance(node, ast.ImportFrom) and word in {alias.name for alias in node.names})
        or (isinstance(node, ast.FunctionDef) and node.name == word)
        for node in nodes_of(FILES[name])
    )


def test_a_search_proposes_and_never_checks():
    """Evidence is checked in one place, where candidates are taken."""
    searches = {name for name in FILES if floor(name) == "search"}
    checking = {name for name in searches if uses(name, "find_fault")}
    assert checking == {"nrs_design.search.certify", "nrs_design.search.fast_check"}
    check = "nrs_design.search.fast_check"
    assert {item.source for item in ours() if item.target == check} == {"nrs_design.search.certify"}
    asking = {item.source for item in ours() if item.target == "nrs_design.search.certify"}
    assert asking.isdisjoint(searches)
    parts = ("find_unfit", "find_misfit", "find_indefinite")
    assert {name for name in searches for part in parts if uses(name, part)} == {check}


def test_the_reader_of_imports_sees_them():
    lazy = {(item.source, item.target) for item in ours()}
    assert ("nrs_design.pipeline.margins", "nrs_design.search.certify") in lazy
    assert ("nrs_design.gating.run", "nrs_design.reporting") in lazy
    typed = {(item.source, item.target) for item in ours() if item.typing_only}
    assert ("nrs_design.cli.report", "nrs_design.pipeline") in typed


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
        # The target of impedance control is listed, and doubted, by name.
        ("Admittance", "impedance", {"spec/describe.py", "design/doubts.py"}),
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


@cache
def names_in(path: Path) -> frozenset[str]:
    """Names that the code of a file uses or imports."""
    used = {node.id for node in nodes_of(path) if isinstance(node, ast.Name)}
    return frozenset(used) | {
        alias.name
        for node in nodes_of(path)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
