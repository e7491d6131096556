"""Small errors that a program can have: one at a time, made in its syntax tree."""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from operator import getitem, setitem
from pathlib import Path
from types import CodeType
from typing import Any

COMPARISONS: dict[type, tuple[type, ...]] = {
    ast.Lt: (ast.LtE, ast.GtE),
    ast.LtE: (ast.Lt, ast.Gt),
    ast.Gt: (ast.GtE, ast.LtE),
    ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,),
    ast.NotEq: (ast.Eq,),
    ast.Is: (ast.IsNot,),
    ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,),
    ast.NotIn: (ast.In,),
}
OPERATORS: dict[type, type] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.FloorDiv,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.LShift: ast.RShift,
    ast.RShift: ast.LShift,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
NAMES = {"all": "any", "any": "all", "max": "min", "min": "max"}
CONDITIONS = (ast.Name, ast.Attribute, ast.Call, ast.Subscript)
# What does not run, and the words of an error.
UNCHANGED = {"annotation", "returns", "decorator_list", "type_params", "exc", "cause"}


Place = tuple[Any, str | int]


@dataclass(frozen=True)
class Mutant:
    """A place of a syntax tree, an item of a list or a field of a node, and what to put there."""

    name: str
    tree: ast.Module
    place: Place
    changed: ast.AST

    def compile(self, path: Path) -> CodeType:
        """Compile the whole module with this one change."""
        with replaced(self.place, self.changed):
            return compile(ast.fix_missing_locations(self.tree), path, "exec")


@contextmanager
def replaced(place: Place, changed: ast.AST) -> Iterator[None]:
    """Put a node into a place for a while."""
    holder, key = place
    read, write = (getattr, setattr) if isinstance(key, str) else (getitem, setitem)
    original = read(holder, key)
    write(holder, key, ast.copy_location(changed, original))
    try:
        yield
    finally:
        write(holder, key, original)


def mutants(source: str) -> list[Mutant]:
    """List every mutant, named by its function and the change; namesakes are numbered."""
    tree = ast.parse(source)
    seen, found = Counter[str](), []
    for scope, returns, parent, place, node in _places(tree, "module", None):
        for changed in _changes(node, parent, returns):
            name = f"{scope}: {_described(parent, place, node, changed)}"
            seen[name] += 1
            number = f" #{seen[name]}" if seen[name] > 1 else ""
            found.append(Mutant(name + number, tree, place, changed))
    return found


def _places(
    parent: ast.AST, scope: str, returns: str | None
) -> Iterator[tuple[str, str | None, ast.AST, Place, ast.AST]]:
    """Yield everything that runs, with its function, what that returns, and the node around it."""
    for field, value in ast.iter_fields(parent):
        if field in UNCHANGED or _is_for_types(parent):
            continue
        for place, node in _children(parent, field, value):
            yield scope, returns, parent, place, node
            if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
                inner = f"{scope}.{node.name}".removeprefix("module.")
                said = getattr(node, "returns", None)
                yield from _places(node, inner, said and ast.unparse(said))
            else:
                yield from _places(node, scope, returns)


def _children(node: ast.AST, field: str, value: object) -> Iterator[tuple[Place, ast.AST]]:
    if isinstance(value, list):
        for index, item in enumerate(value):
            if isinstance(item, ast.AST):
                yield (value, index), item
    elif isinstance(value, ast.AST):
        yield (node, field), value


def _is_for_types(node: ast.AST) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"


def _described(parent: ast.AST, place: Place, node: ast.AST, changed: ast.AST) -> str:
    # A number or a name alone says little: show what stands around it.
    whole = parent if isinstance(node, (ast.Constant, *CONDITIONS)) else node
    before = _text(whole)
    if whole is node:
        return f"{before} -> {_text(changed)}"
    with replaced(place, changed):
        return f"{before} -> {_text(whole)}"


def _text(node: ast.AST) -> str:
    return ast.unparse(node).strip().splitlines()[0]


def _changes(node: ast.AST, parent: ast.AST, returns: str | None) -> Iterator[ast.AST]:
    """Yield what may stand in the place of a node by mistake."""
    yield from _changed_expression(node)
    if isinstance(node, ast.Return) and returns:
        yield from _other_results(node, returns)
    if isinstance(node, CONDITIONS) and _is_condition(node, parent):
        yield ast.UnaryOp(ast.Not(), node)
    if isinstance(node, ast.AugAssign) and type(node.op) in OPERATORS:
        yield ast.AugAssign(node.target, OPERATORS[type(node.op)](), node.value)
    if isinstance(node, ast.Raise) or (
        isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)
    ):
        yield ast.Pass()
    if isinstance(node, ast.Expr) and isinstance(node.value, (ast.Yield, ast.YieldFrom)):
        nothing = ast.Expr(ast.YieldFrom(ast.Tuple([], ast.Load())))
        if _text(node) != _text(nothing):
            yield nothing
    if isinstance(node, ast.Break):
        yield ast.Continue()
    if isinstance(node, ast.Continue):
        yield ast.Break()


def _changed_expression(node: ast.AST) -> Iterator[ast.AST]:
    match node:
        case ast.Compare():
            for i, op in enumerate(node.ops):
                for other in COMPARISONS[type(op)]:
                    ops = [*node.ops[:i], other(), *node.ops[i + 1 :]]
                    yield ast.Compare(node.left, ops, node.comparators)
        case ast.BoolOp():
            yield ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values)
            for i in range(len(node.values)):
                rest = node.values[:i] + node.values[i + 1 :]
                yield ast.BoolOp(node.op, rest) if len(rest) > 1 else rest[0]
        case ast.UnaryOp(ast.Not() | ast.USub(), operand):
            yield operand
        case ast.Constant(bool(value)):
            yield ast.Constant(not value)
        case ast.Constant(int(value)):
            yield ast.Constant(value + 1)
            yield ast.Constant(value - 1)
        case ast.BinOp(left, op, right) if type(op) in OPERATORS:
            yield ast.BinOp(left, OPERATORS[type(op)](), right)
        case ast.Name(name, ast.Load()) if name in NAMES:
            yield ast.Name(NAMES[name], ast.Load())


def _other_results(node: ast.Return, returns: str) -> Iterator[ast.AST]:
    """Yield other answers that type checkers would let pass."""
    # Another constant is a change of its own.
    if node.value is not None and not isinstance(node.value, ast.Constant):
        for result in (True, False) if returns == "bool" else (None,) if "None" in returns else ():
            yield ast.Return(ast.Constant(result))


def _is_condition(node: ast.AST, parent: ast.AST) -> bool:
    if isinstance(parent, ast.comprehension):
        return node in parent.ifs
    return isinstance(parent, (ast.If, ast.While, ast.IfExp)) and node is parent.test
