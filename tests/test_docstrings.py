"""Every public name is documented in numpydoc style."""

import importlib
import inspect
import pkgutil
import re

import pytest

import nrs_design

MODULES = sorted(
    info.name
    for info in pkgutil.walk_packages(nrs_design.__path__, "nrs_design.")
    if not info.name.endswith("__main__")
)
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


@pytest.mark.parametrize("name", MODULES)
def test_documented(name):
    module = importlib.import_module(name)
    assert module.__doc__, name
    for what, thing in public(module):
        text = inspect.getdoc(thing)
        own = thing.__doc__ if inspect.isclass(thing) else text
        assert own, f"{name}.{what} has no docstring"
        summary = own.strip().split("\n\n")[0].strip()
        assert summary.endswith((".", ":", "?", "``")), f"{name}.{what}: {summary!r}"
        for section in SECTION.finditer(text):
            assert len(section["line"]) == len(section["title"]), f"{name}.{what}"


@pytest.mark.parametrize("name", MODULES)
def test_parameters_that_are_described_exist(name):
    for what, thing in public(importlib.import_module(name)):
        text = inspect.getdoc(thing) or ""
        match = re.search(
            r"^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)", text, re.DOTALL | re.MULTILINE
        )
        if not match or (inspect.isclass(thing) and not hasattr(thing, "__dataclass_fields__")):
            continue
        if inspect.isclass(thing):
            known = set(thing.__dataclass_fields__)
        else:
            known = set(inspect.signature(thing).parameters)
        described = re.findall(r"^\*{0,2}(\w[\w, *]*?) ?:", match[1], re.MULTILINE)
        names = {part.strip(" *") for line in described for part in line.split(",")}
        assert names <= known, f"{name}.{what} describes {names - known}"


def is_command(name, what):
    """A command of the same name as its module: its options carry their help."""
    return name.startswith("nrs_design.cli.") and name.rpartition(".")[2] == what


def test_three_parameters_or_more_are_described():
    silent = [
        f"{name}.{what}"
        for name in MODULES
        for what, thing in public(importlib.import_module(name))
        if inspect.isfunction(thing)
        and not is_command(name, what)
        and len(inspect.signature(thing).parameters.keys() - {"self", "cls"}) >= 3
        and not re.search(r"^Parameters\n-+\n", inspect.getdoc(thing) or "", re.MULTILINE)
    ]
    assert not silent


def test_walk_reaches_the_core():
    assert {"nrs_design.proof.exact", "nrs_design.cli.app", "nrs_design.spec.load"} <= set(MODULES)


def test_whoever_describes_parameters_describes_them_all():
    silent = {}
    for module in map(importlib.import_module, MODULES):
        for what, function in public(module):
            text = inspect.getdoc(function) or ""
            section = re.search(
                r"^Parameters\n-+\n(.*?)(?=^\w[\w ]*\n-+$|\Z)", text, re.DOTALL | re.MULTILINE
            )
            if inspect.isfunction(function) and section:
                named = " ".join(re.findall(r"^\S[^:\n]*", section[1], re.MULTILINE))
                known = inspect.signature(function).parameters.keys() - {"self", "cls"}
                silent[f"{module.__name__}.{what}"] = known - set(re.findall(r"\w+", named))
    assert {name: names for name, names in silent.items() if names} == {}
    assert len(silent) > 100
