"""Every name is documented: that of the public API in numpydoc, an inner one in a few lines."""

import ast
import importlib
import inspect
import pkgutil
import re
from pathlib import Path

import nrs_design

MODULES = sorted(
    info.name
    for info in pkgutil.walk_packages(nrs_design.__path__, "nrs_design.")
    if not info.name.endswith("__main__")
)
# Folders whose docstrings are numpydoc, as a page shows them.
API = ("api/", "identification/api/")
UNDERLINED = re.compile(r"^\w[\w ]*\n-{3,}$", re.MULTILINE)
SECTION = re.compile(
    r"^(?P<title>Parameters|Returns|Raises|Yields|Notes)\n(?P<line>-+)$", re.MULTILINE
)


def public(module):
    """Public functions and classes that a module defines, and the public methods of its classes."""
    for name, thing in list(vars(module).items()):
        if name.startswith("_") or getattr(thing, "__module__", None) != module.__name__:
            continue
        # A function that keeps its results is one inside.
        thing = inspect.unwrap(thing)
        if inspect.isfunction(thing) or inspect.isclass(thing):
            yield name, thing
        if inspect.isclass(thing):
            for key, member in list(vars(thing).items()):
                function = getattr(member, "__func__", getattr(member, "fget", member))
                # A field whose default is a function is not a method.
                is_method = getattr(function, "__qualname__", "") == f"{name}.{key}"
                if not key.startswith("_") and is_method and inspect.isfunction(function):
                    yield f"{name}.{key}", function


def everything():
    for name in MODULES:
        for what, thing in public(importlib.import_module(name)):
            yield f"{name}.{what}", thing


def own_text(thing):
    return (thing.__doc__ if inspect.isclass(thing) else inspect.getdoc(thing)) or ""


def test_everything_is_documented():
    silent = [name for name in MODULES if not importlib.import_module(name).__doc__]
    silent += [name for name, thing in everything() if not own_text(thing)]
    assert not silent


def test_a_summary_is_a_sentence():
    summaries = {
        name: own_text(thing).strip().split("\n\n")[0].strip() for name, thing in everything()
    }
    ends = (".", ":", "?", "``")
    assert not {name: text for name, text in summaries.items() if not text.endswith(ends)}


def test_sections_are_underlined_to_their_length():
    assert not [
        (name, section["title"])
        for name, thing in everything()
        for section in SECTION.finditer(inspect.getdoc(thing) or "")
        if len(section["line"]) != len(section["title"])
    ]


def described(thing):
    match = re.search(
        r"^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)",
        inspect.getdoc(thing) or "",
        re.DOTALL | re.MULTILINE,
    )
    lines = re.findall(r"^\*{0,2}(\w[\w, *]*?) ?:", match[1], re.MULTILINE) if match else []
    return {part.strip(" *") for line in lines for part in line.split(",")}


def parameters(thing):
    if inspect.isclass(thing):
        fields = getattr(thing, "__dataclass_fields__", None)
        return None if fields is None else set(fields)
    return set(inspect.signature(thing).parameters)


def test_whoever_describes_parameters_describes_them_all_and_no_others():
    told = {
        name: (described(thing), known - {"self", "cls"}, inspect.isfunction(thing))
        for name, thing in everything()
        if (known := parameters(thing)) is not None and described(thing)
    }
    assert len(told) > 6
    assert {n: named - known for n, (named, known, _) in told.items() if named - known} == {}
    wanted = {n: known - named for n, (named, known, is_function) in told.items() if is_function}
    assert {name: names for name, names in wanted.items() if names} == {}


def offered():
    """What `nrs_design` offers and its public methods, with their names."""
    for name in nrs_design.__all__:
        thing = getattr(nrs_design, name)
        yield name, thing
        for key, member in vars(thing).items() if inspect.isclass(thing) else ():
            if not key.startswith("_") and inspect.isfunction(member):
                yield f"{name}.{key}", member


def test_three_parameters_or_more_of_what_is_offered_are_described():
    silent = [
        name
        for name, thing in offered()
        if inspect.isfunction(thing)
        and len(inspect.signature(thing).parameters.keys() - {"self", "cls"}) >= 3
        and not re.search(r"^Parameters\n-+\n", inspect.getdoc(thing) or "", re.MULTILINE)
    ]
    assert not silent


def test_inner_docstrings_have_no_sections():
    root = Path(nrs_design.__file__).parent
    sectioned = [
        f"{path.relative_to(root)}:{node.lineno}"
        for path in sorted(root.rglob("*.py"))
        if not path.relative_to(root).as_posix().startswith(API)
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.ClassDef | ast.FunctionDef)
        and UNDERLINED.search(ast.get_docstring(node) or "")
    ]
    assert not sectioned
