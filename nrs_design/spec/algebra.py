"""Sums, products, quotients and powers in a text: parsed by Python's grammar, never run as code."""

from __future__ import annotations

import ast
import re
from collections.abc import Callable, Mapping
from typing import TypeVar

T = TypeVar("T")
Operators = Mapping[type[ast.AST], Callable[..., T]]
_NAMED = re.compile(r"[v0-9 +*/()-]*")


def read_algebra(
    text: str,
    leaf: re.Pattern[str],
    read: Callable[[str], T],
    operators: Operators[T],
    power: Callable[[T, int], T] | None = None,
) -> T:
    """Evaluate an expression: read each leaf, combine by the operators; a ValueError if it is none.

    `leaf` is a pattern of names and numbers. Exponents are integers. Python sees neither: a leaf
    stands for it as a name of our own.
    """
    leaves: list[str] = []

    def named(found: re.Match[str]) -> str:
        leaves.append(found[0])
        return f" v{len(leaves) - 1} "

    def value(node: ast.expr) -> T:
        match node:
            case ast.Name(id=name):
                return read(leaves[int(name[1:])])
            case ast.Constant(value=int(number)):
                return read(str(number))
            case ast.UnaryOp(op=op, operand=inner) if type(op) in operators:
                return operators[type(op)](value(inner))
            case ast.BinOp(
                left=left,
                op=ast.Pow(),
                right=(ast.Constant() | ast.UnaryOp(operand=ast.Constant())) as exponent,
            ) if power:
                return power(value(left), ast.literal_eval(exponent))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in operators:
                return operators[type(op)](value(left), value(right))
        raise ValueError(f"{text!r} is not algebra")

    code = leaf.sub(named, text).strip().replace("^", "**")
    if "**" in text or not _NAMED.fullmatch(code):
        raise ValueError(f"{text!r} holds what is no leaf and no operator")
    try:
        tree = ast.parse(code, mode="eval")
    except (SyntaxError, MemoryError, RecursionError):
        raise ValueError(f"{text!r} is not algebra") from None
    return value(tree.body)
