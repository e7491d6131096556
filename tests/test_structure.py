"""The house has floors, and imports point downward only; docs/architecture.md lists them."""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from nrs_design.cli.app import COMMANDS
from nrs_design.wings import FORMATS, WINGS
from tests.package import FILES, nodes_of
from tests.support import ROOT

# Evidence about a block holds evidence of any kind: the table of them all has its reader.
KNOWN_CYCLES = {
    ("nrs_design.proof.evidence", "nrs_design.proof.evidence.block_triangular"),
    # The root names for type checkers what it loads when it is asked, and holds the version.
    ("nrs_design.api", "nrs_design"),
}
# What the dissertation says of its robot is computed by the robot.
BETWEEN_WINGS = {("thesis", "robot")}
# Where the core hands over to a wing, and to which module.
REACHED = {
    # Commands: any of the table.
    ("nrs_design.cli.app", None, None),
    # Formats of an export: any of the table.
    ("nrs_design.exporters", None, None),
    # A spec of kind robot has a page of its own.
    ("nrs_design.cli.report", "robot", "pipeline"),
    ("nrs_design.cli.report", "robot", "reporting.robot"),
    # Records and runs, from the library.
    ("nrs_design.api.identified", "identification", "api.library"),
    ("nrs_design.api.study", "identification", "api.library"),
}
STAGES = {"models", "design", "loop", "search"}
# What a command may use of a stage: its door, or a module of nouns and words.
DOORS = {
    "nrs_design.models.axis",
    "nrs_design.models.contact",
    "nrs_design.search.certification",
    "nrs_design.search.method",
    "nrs_design.design.measures",
}
# What is found in a stage, and printed or written as it is: for annotations only.
PRINTED = {
    "nrs_design.design.analysis",
    "nrs_design.design.goals",
    "nrs_design.design.linear_parts",
    "nrs_design.design.passivity",
    "nrs_design.search.margin",
}


@dataclass(frozen=True)
class Import:
    source: str
    target: str
    line: int
    typing_only: bool


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


def wing(module: str) -> str | None:
    """The wing in which a module lies; None for the core."""
    return floor(module) if floor(module) in WINGS else None


def role(module: str) -> str:
    """The floor of a module; in a wing, which has floors of the same names, that within it."""
    inner = [*module.split("."), "", ""][2]
    home = FILES.get(f"nrs_design.{inner}")
    return inner if wing(module) and home and home.name == "__init__.py" else floor(module)


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


def test_the_core_imports_no_wing():
    assert [item for item in ours() if wing(item.target) and not wing(item.source)] == []


def test_a_wing_imports_no_other_wing():
    pairs = {(wing(item.source), wing(item.target)) for item in ours()}
    assert {(a, b) for a, b in pairs if a and b and a != b} == BETWEEN_WINGS


def test_a_wing_has_floors_too():
    rank = {name: height for height, name in enumerate(floors())}
    rank |= dict.fromkeys(WINGS, -1)
    up = [
        item
        for item in ours()
        if wing(item.source)
        and wing(item.source) == wing(item.target)
        and rank[role(item.target)] > rank[role(item.source)]
    ]
    assert not up


def test_the_core_reaches_wings_in_these_places_only():
    found = {
        (name, *(getattr(argument, "value", None) for argument in node.args))
        for name, path in FILES.items()
        for node in nodes_of(path)
        if isinstance(node, ast.Call) and getattr(node.func, "id", None) == "load_wing"
    }
    places = {(name, at if at in WINGS else None, inner) for name, at, inner in found}
    assert {(n, at, inner if at else None) for n, at, inner in places} == REACHED
    assert {f"nrs_design.{at}.{inner}" for _, at, inner in REACHED if at} <= FILES.keys()


def test_every_command_and_format_of_a_wing_is_in_its_module():
    modules = {f"nrs_design.{name}.cli.{c}" for name, commands in WINGS.items() for c in commands}
    assert modules <= FILES.keys()
    assert {c for commands in WINGS.values() for c in commands} <= set(COMMANDS)
    assert {f"nrs_design.{wing}.export" for wing in FORMATS.values()} <= FILES.keys()


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


def test_clocks_are_read_by_the_fuse_and_for_the_eye_only():
    """What a search begins, and where it ends, is counted: a clock would differ under load."""
    assert {item.source for item in imports() if item.target == "time"} == {
        "nrs_design.search.work",
        # How long something took, told beside what was found.
        "nrs_design.search.acceptance",
        "nrs_design.pipeline.runs",
        "nrs_design.cli.printing",
        "nrs_design.cli.gate",
    }
    limited = {name for name in FILES if "time_limit" in FILES[name].read_text(encoding="utf-8")}
    assert limited == {"nrs_design.search.sdp"}


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
    # What IPython, os, named tuples and ctypes call so is public.
    known = {"_repr_html_", "_exit", "_replace", "_fields_"}
    private = [
        (path.name, name)
        for path in sorted((ROOT / "tests").rglob("*.py"))
        for name in private_names(path)
        if re.match(r"_[^_]", name) and name not in known
    ]
    assert not private


@pytest.mark.parametrize("above", ["cli", "gating", "exporters"])
def test_stages_are_known_to_the_pipeline_only(above):
    """A command asks the pipeline; it takes types of a stage, to print them.

    Those of the robot ask its models.
    """
    inside = [
        item
        for item in ours()
        if role(item.source) == above
        and role(item.target) in STAGES
        and item.target not in DOORS
        and not (item.typing_only and item.target in PRINTED)
        and not item.target.startswith("nrs_design.robot.models.")
    ]
    assert not inside


def test_a_report_assembles_and_searches_nothing():
    """It shows what the pipeline gives it, and draws the curves of a design."""
    read = {item.target for item in ours() if role(item.source) == "reporting"}
    assert {name for name in read if floor(name) in ("loop", "search")} == {
        "nrs_design.search.certification",
        "nrs_design.search.margin",
    }


VERBS = {
    ("nrs_design.spec.build_plant", "build_plant"),
    ("nrs_design.design.analysis", "design_controllers"),
    ("nrs_design.design.analysis", "analyze_design"),
    ("nrs_design.loop.assemble", "assemble"),
    ("nrs_design.loop.assemble", "assemble_matrices"),
    ("nrs_design.search.certify", "certify"),
}


def as_one(name: str) -> str:
    return "nrs_design.pipeline" if floor(name) == "pipeline" else name


def test_only_the_pipeline_calls_the_stages():
    """Published matrices are certified as they are, and a re-check builds the plant of its spec.

    The axes of a ROS 2 controller come from no spec, so no other stage is before their proof. A
    monitor takes the ranges of the motor from the plant of its spec.
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
        "nrs_design.exporters.monitor_limits",
        "nrs_design.loop.assemble",
        "nrs_design.thesis.switching",
        "nrs_design.ros2.check",
        "nrs_design.ros2.export",
    }


# Functions that do one thing in several modules; a command is named like what it calls.
SHARED = {
    # Modules of a table offer them all.
    *("render", "header_text", "source_text"),
    *("choose", "analyze"),
    # The library at the door, and the stage behind it.
    *("certify", "verify"),
    # One operation on numbers of other types, one question to another noun.
    *("add", "multiply", "read_integer", "too_stiff"),
}


def homes(kind: type[ast.ClassDef] | type[ast.FunctionDef]) -> dict[str, list[str]]:
    """Public names at the top of modules, and the modules that define them."""
    found: dict[str, list[str]] = {}
    for name, path in FILES.items():
        for node in ast.iter_child_nodes(nodes_of(path)[0]):
            if isinstance(node, kind) and not node.name.startswith("_"):
                found.setdefault(node.name, []).append(name)
    return found


def test_a_class_name_means_one_thing():
    found = homes(ast.ClassDef)
    assert len(found) > 500
    assert {name: where for name, where in found.items() if len(where) > 1} == {}


def test_a_function_name_means_one_thing():
    found = homes(ast.FunctionDef)
    below = {name: [m for m in where if role(m) != "cli"] for name, where in found.items()}
    assert {name for name, where in below.items() if len(where) > 1} == SHARED


def uses(name: str, word: str) -> bool:
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
    place = "nrs_design.search.acceptance"
    assert checking == {place}
    takers = ("take_candidate", "first_accepted", "attempted")
    taking = {name for name in searches for word in takers if uses(name, word)}
    assert taking == {place, "nrs_design.search.certify"}
    assert searches.isdisjoint(
        item.source for item in ours() if item.target == "nrs_design.search.certify"
    )
    parts = ("find_unfit", "find_misfit", "find_indefinite")
    assert not any(uses(name, part) for name in searches for part in parts)


def test_the_reader_of_imports_sees_them():
    lazy = {(item.source, item.target) for item in ours()}
    assert ("nrs_design.pipeline.margins", "nrs_design.search.certify") in lazy
    assert ("nrs_design.gating.run", "nrs_design.reporting") in lazy
    typed = {(item.source, item.target) for item in ours() if item.typing_only}
    assert ("nrs_design.cli.goals", "nrs_design.pipeline.certification") in typed


# Folders whose tests are of their modules; what a file in one of them is across is listed.
MIRRORED = (
    "certificates",
    "cli",
    "coq",
    "exporters",
    "gating",
    "loop",
    "models",
    "robot",
    "ros2",
    "simulation",
    "spec",
)


def test_a_test_file_is_of_a_module_or_listed_as_one_across_them():
    """A file for a module that was merged away would be looked for in vain."""
    homes = {(path.relative_to(ROOT / "nrs_design").parts[0], path.stem) for path in FILES.values()}
    homes |= {(room, path.parent.name) for room in MIRRORED for path in FILES.values()}
    across = {
        path.relative_to(ROOT / "tests").as_posix()
        for room in MIRRORED
        for path in (ROOT / "tests" / room).rglob("test_*.py")
        if (room, path.stem.removeprefix("test_")) not in homes
    }
    listed = (ROOT / "tests" / "across.txt").read_text(encoding="utf-8").splitlines()
    assert sorted(across) == [line for line in listed if not line.startswith("#")]
