"""Numbers in certificate files: integers and ratios of integers, never floats.

A dataclass, or a named tuple, is written field by field, and read by the types of its fields. A
field that holds its default is left out; one that the class does not have is refused.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import MISSING, fields, is_dataclass
from fractions import Fraction
from functools import cache
from types import NoneType, UnionType
from typing import Any, TypeVar, cast, get_args, get_origin, get_type_hints

from nrs_design.proof.bounds import at_least, at_most, lower, upper
from nrs_design.proof.exact import bit_length, is_too_large
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import quoted

Matrix = tuple[tuple[int, ...], ...]
T = TypeVar("T")

# Python reads and writes integers of at most 4300 decimal digits, `read_ratio` of at most 2000.
MAX_INTEGER_BITS = 14_000
MAX_RATIO_BITS = 6_640
MAX_ENTRIES = 100_000
# The word for switching without rules.
WITHOUT_RULES = "arbitrary"
# Deciding a form for every mode takes about rows^3 steps each on their numbers: a minute at this.
MAX_FAMILY_WORK = 10**10
# There is a function for every step of a round, and for every state of an automaton.
MAX_ROUND, MAX_STATES = 100, 1000


def written(value: Any) -> Any:
    """Return a value as JSON holds it.

    A matrix that is the only one of an object stands among its other fields. A ValueError if a
    number of a matrix has more digits than a file holds.
    """
    if isinstance(value, RationalMatrix):
        return _matrix_fields(value)
    if isinstance(value, Fraction):
        return str(value)
    if not _has_fields(value):
        return [written(item) for item in value] if isinstance(value, tuple) else value
    result: dict[str, Any] = {}
    for name, (_, default, _) in _hints(cast(Hashable, type(value))).items():
        item = getattr(value, name)
        if isinstance(item, RationalMatrix):
            result |= _matrix_fields(item)
        elif item != default:
            result[name] = written(item)
    return result


def _has_fields(value: object) -> bool:
    """Tell whether a value or a class is a dataclass or a named tuple."""
    return is_dataclass(value) or hasattr(value, "_fields")


def read_object(kind: type[T], value: object) -> T:
    """Read a dataclass or a named tuple that `written` has written.

    A KeyError, TypeError or ValueError if a field is missing, malformed or unknown.
    """
    if not isinstance(value, Mapping):
        raise TypeError(f"expected an object, not {quoted(str(value))}")
    found: dict[str, Any] = {}
    known: set[str] = set()
    for name, (hint, default, signed) in _hints(cast(Hashable, kind)).items():
        if hint is RationalMatrix:
            found[name] = _read_matrix(value)
            known |= {"numerators", "denominator"}
        elif name in value or default is MISSING:
            read = read_signed if signed else _read
            found[name] = read(hint, value[name])
            known.add(name)
    if unknown := value.keys() - known:
        raise ValueError(f"unknown field {quoted(min(map(str, unknown)))}")
    return kind(**found)


@cache
def _hints(kind: Hashable) -> dict[str, tuple[Any, Any, bool]]:
    """Return the type of every field, its default, and whether its number has a sign."""
    hints = get_type_hints(kind)
    if not is_dataclass(kind):
        defaults = cast(Any, kind)._field_defaults
        return {name: (hint, defaults.get(name, MISSING), False) for name, hint in hints.items()}
    return {
        field.name: (hints[field.name], field.default, bool(field.metadata))
        for field in fields(kind)
    }


def _read(hint: Any, value: object) -> Any:
    if hint in _PLAIN:
        return _PLAIN[hint](value)
    if get_origin(hint) is UnionType:
        # None, the default of such a field, is never written.
        (inner,) = (part for part in get_args(hint) if part is not NoneType)
        return _read(inner, value)
    if get_origin(hint) is not tuple:
        return read_object(hint, value)
    first, *others = get_args(hint)
    items = read_list(value)
    if others == [...]:
        return tuple(_read(first, item) for item in items)
    return tuple(_read(part, item) for part, item in zip((first, *others), items, strict=True))


def _matrix_fields(A: RationalMatrix) -> dict[str, Any]:
    if max(bit_length(A.numerators), A.denominator.bit_length()) > MAX_INTEGER_BITS:
        raise ValueError("a number of a mode or a reset has more digits than a certificate holds")
    return {"numerators": [list(row) for row in A.numerators], "denominator": A.denominator}


def _read_matrix(value: Any) -> RationalMatrix:
    rows = tuple(
        tuple(read_integer(entry) for entry in read_list(row))
        for row in read_list(value["numerators"])
    )
    denominator = read_integer(value["denominator"])
    if denominator <= 0 or not rows or not rows[0] or len(set(map(len, rows))) != 1:
        raise ValueError("a matrix has rows of different lengths, or no positive denominator")
    return RationalMatrix(rows, denominator)


def read_integers(value: Any) -> Matrix:
    """Read a matrix of integers."""
    matrix = tuple(tuple(read_integer(entry) for entry in read_list(row)) for row in value)
    # Nothing is decided of rows beyond a square, such as those of an automaton.
    if matrix and is_too_large(matrix[: len(matrix[0])]):
        raise ValueError("a matrix is too large to check")
    return matrix


def read_integer(value: object) -> int:
    """Read an integer; a truth value is not one."""
    return _of_type(value, int, "an integer")


def read_text(value: object) -> str:
    """Read a text."""
    return _of_type(value, str, "a text")


def read_ratio(value: object) -> Fraction:
    """Read a nonnegative ratio of integers, such as 3/8."""
    text = read_text(value)
    if not re.fullmatch(r"[0-9]{1,2000}(/[0-9]{1,2000})?", text):
        raise ValueError(f"{quoted(text)} is not a ratio of integers")
    return Fraction(text)


def read_signed(hint: object, value: object) -> Fraction:
    """Read a ratio of integers with a sign, such as -3/8."""
    text = read_text(value)
    return -read_ratio(text[1:]) if text.startswith("-") else read_ratio(text)


def read_list(value: object) -> list[Any]:
    """Read a list."""
    return _of_type(value, list, "a list")


def _of_type(value: object, kind: type[T], words: str) -> T:
    """Return a value that JSON has as this type; a text may be a word of an enumeration."""
    if not isinstance(value, kind) or (kind is int and type(value) is not int):
        raise TypeError(f"expected {words}, not {quoted(str(value))}")
    return value


_PLAIN: Mapping[Any, Callable[[object], Any]] = {
    str: read_text,
    int: read_integer,
    bool: lambda value: _of_type(value, bool, "true or false"),
    Fraction: read_ratio,
    Matrix: read_integers,
    RationalMatrix: _read_matrix,
    Time: lambda value: Time(read_text(value)),
}


def system_fields(system: SwitchedSystem) -> dict[str, Any]:
    """Return what a certificate says about its system, apart from the name."""
    fields: dict[str, Any] = written(system)
    del fields["name"]
    return {**fields, "switching": fields.get("switching", WITHOUT_RULES)}


def read_system(name: str, fields: Mapping[str, Any]) -> SwitchedSystem:
    """Read the system that `system_fields` has written; other keys are not looked at.

    A KeyError, TypeError or ValueError if a field is missing or malformed, a matrix has no shape or
    no positive denominator, two modes have one name, or the modes are too large to check.
    """
    own = {key: value for key, value in fields.items() if key in SwitchedSystem.__slots__}
    own |= {"name": name}
    if fields["switching"] == WITHOUT_RULES:
        del own["switching"]
    system = read_object(SwitchedSystem, own)
    _check_modes(system.modes, len(system.states))
    if system.contact is not None:
        _check_work(system.contact.free, 1 + len(system.contact.pulls))
    if (clock := system.clock) is not None:
        most = MAX_ROUND if clock.is_round else MAX_STATES
        if not 2 <= clock.length <= most or len(clock.ahead) > most:
            raise ValueError(f"a round, or an automaton, has from 2 to {most} steps or states")
    return system


def _check_modes(modes: Sequence[Mode], states: int) -> None:
    sizes = [len(mode.A.numerators) for mode in modes]
    if len({mode.name for mode in modes}) < len(modes):
        raise ValueError("two modes have the same name")
    if any(mode.A.shape[0] != mode.A.shape[1] for mode in modes):
        raise ValueError("a mode is not square")
    if not sizes or max(sizes) != states:
        raise ValueError("the largest mode does not have the states that are named")
    _check_work(modes)


def _check_work(modes: Iterable[Mode], times: int = 1) -> None:
    matrices = (mode.A.numerators for mode in modes)
    if times * sum(len(N) ** 3 * bit_length(N) for N in matrices) > MAX_FAMILY_WORK:
        raise ValueError("the modes are too large to check")


def find_unreadable(value: object) -> str | None:
    """TRUSTED: say why a certificate file could not hold the numbers of evidence, or None.

    An integer of NumPy overflows without a word, so it is refused as floats are.
    """
    if value is None or isinstance(value, str):
        return None
    if isinstance(value, Fraction):
        return _find_long((value.numerator, value.denominator), MAX_RATIO_BITS)
    if isinstance(value, tuple | list):
        parts = tuple(value)
        if len(parts) > MAX_ENTRIES:
            return f"a list has {len(parts)} entries, more than {MAX_ENTRIES} are not read"
        if set(map(type, parts)) == {int}:
            return _find_long(parts, MAX_INTEGER_BITS)  # A row of a matrix, at once
    elif is_dataclass(value):
        parts = tuple(getattr(value, field.name) for field in fields(value))
    else:
        return _find_long((value,), MAX_INTEGER_BITS)
    return next((fault for part in parts if (fault := find_unreadable(part)) is not None), None)


def _find_long(numbers: tuple[object, ...], bits: int) -> str | None:
    for number in numbers:
        if type(number) is not int:
            return f"a number is of type {type(number).__name__}, not an exact integer"
        if number.bit_length() > bits:
            return f"a number has {number.bit_length()} bits, more than {bits} are not read"
    return None


def rate_text(rate: Fraction, time: Time) -> str:
    """Write a rate: exactly if that is short, else rounded to its safe side (slower decay)."""
    return lower(rate) if time is Time.CONTINUOUS else upper(rate)


def rate_words(rate: Fraction, time: Time) -> str:
    """Write which rate is shown, such as ``alpha = 0.5 1/s``, ``>=`` and ``<=`` where rounded."""
    if time is Time.CONTINUOUS:
        return f"alpha {at_least(rate, '1/s')}"
    return f"rho {at_most(rate)}"
