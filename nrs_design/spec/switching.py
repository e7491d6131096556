"""Which switching signals there are: dwell time, allowed transitions, resets."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import Annotated, Any

from pydantic import Field

from nrs_design.errors import SpecError
from nrs_design.proof.text import counted, quoted
from nrs_design.spec import kinds
from nrs_design.spec.check import NO_SUCH, Reference, Row, each, refuse
from nrs_design.spec.exact import parse_exact
from nrs_design.spec.faults import Location, as_text, fault, reported
from nrs_design.spec.fields import Exact, Label
from nrs_design.spec.model import (
    ExpandedBy,
    ParsedBy,
    SpecModel,
    fields_schema,
    optional,
    pair_schema,
    required,
)
from nrs_design.spec.quantity import QUANTITY_PATTERN, parse_quantity

MAX_TRANSITIONS = 20_000
MAX_DIMENSION = 64
# Bits of the denominator of a matrix, or of the parameters; usual numbers stay far below.
MAX_DENOMINATOR_BITS = 1024
# Seconds or steps; a system with slower modes is better written in another unit of time.
LONGEST_DWELL = 4096

ARBITRARY = "arbitrary"
# The rules are those that the mode logic of the spec keeps.
MODE_LOGIC = "mode-logic"
_FORM = "write 'arbitrary', or {dwell_time: ..., transitions: [[from, to], ...]}"

_Row = Annotated[tuple[Exact, ...], Field(min_length=1, max_length=MAX_DIMENSION)]
_Matrix = Annotated[tuple[_Row, ...], Field(min_length=1, max_length=MAX_DIMENSION)]
Transition = tuple[str, str]


@dataclass(frozen=True, slots=True)
class DwellTime:
    """Shortest time in a mode."""

    text: str  # As written, such as ``2.76 s`` or ``3 steps``
    value: Fraction  # In s, or the number of steps
    unit: str  # Seconds or steps


@dataclass(frozen=True, slots=True)
class DwellObstacle:
    """Reason why a spec and a dwell time exclude each other, with the remedy."""

    message: str
    remedy: str


# One time for all modes, or times by name of mode; modes without an entry have no dwell time.
DwellTimes = DwellTime | dict[str, DwellTime]


def parse_dwell_time(text: str) -> DwellTime:
    """Read a time such as ``2.76 s``, or a number of steps such as ``3 steps``.

    A `SpecError` if it is neither, is not positive, or is beyond 4096 s or steps.
    """
    number, _, unit = text.partition(" ")
    if unit.strip(" ") in ("step", "steps"):
        dwell = DwellTime(text, parse_exact(number), "steps")
        if dwell.value.denominator != 1:
            raise SpecError(f"{quoted(text)} is not a whole number", remedy="write whole steps")
    else:
        dwell = DwellTime(text, parse_quantity(text, kinds.DWELL_TIME).exact, "s")
    if not 0 < dwell.value <= LONGEST_DWELL:
        raise SpecError(
            f"{quoted(text)} is not between 0 and {LONGEST_DWELL} {dwell.unit}",
            remedy="give a positive time, or leave it out",
        )
    return dwell


def read_dwell_times(value: object) -> DwellTimes:
    """Read one time for all modes, or times by the names of modes."""
    if not isinstance(value, Mapping):
        return _read_dwell_time(value)
    if not value:
        raise fault("no mode is named", "write one time for all, or {a: 1 s, b: 2 s}")
    return {name: _read_dwell_time(dwell, name) for name, dwell in value.items()}


def _read_dwell_time(value: object, *at: str) -> DwellTime:
    if isinstance(value, DwellTime):
        return value
    text = as_text(value, *at)
    return reported(lambda: parse_dwell_time(text), *at)


def _read_transitions(value: object) -> tuple[Transition, ...]:
    if not isinstance(value, tuple | list):
        raise fault("expected a list", "write [[from, to], ...]")
    if len(value) > MAX_TRANSITIONS:
        raise fault(f"more than {MAX_TRANSITIONS} transitions are not read", "list fewer")
    found: dict[Transition, None] = {}
    for index, pair in enumerate(value):
        if not isinstance(pair, tuple | list) or len(pair) != 2:
            raise fault("expected two names", "write [from, to]", index)
        transition = (as_text(pair[0], index, 0), as_text(pair[1], index, 1))
        if transition[0] == transition[1]:
            raise fault("a switch leads to another mode", "remove it: staying is free", index)
        found[transition] = None
    return tuple(found)


_ONE_DWELL: dict[str, Any] = {"type": "string", "pattern": QUANTITY_PATTERN}
DWELL_SCHEMA: dict[str, Any] = {
    "anyOf": [
        _ONE_DWELL,
        {"type": "object", "additionalProperties": _ONE_DWELL, "minProperties": 1},
    ]
}
_TRANSITIONS_SCHEMA: dict[str, Any] = {
    "type": "array",
    "items": pair_schema({"type": ["string", "integer"]}),
}


class SwitchingSpec(SpecModel, unsaid="most"):
    """Rules for the switching signal; without any, it is arbitrary."""

    dwell_time: Annotated[DwellTimes | None, ParsedBy(read_dwell_times, DWELL_SCHEMA)] = optional(
        "shortest time in a mode in s or steps; one for all, or by name: {a: 1 s, b: 2 s}",
        stronger="smaller",
    )
    longest_dwell_time: Annotated[DwellTimes | None, ParsedBy(read_dwell_times, DWELL_SCHEMA)] = (
        optional("longest time in a mode; one for all, or by name: {a: 5 s}", stronger="larger")
    )
    transitions: Annotated[
        tuple[Transition, ...] | None, ParsedBy(_read_transitions, _TRANSITIONS_SCHEMA)
    ] = optional("allowed switches as [from, to]; default: all", stronger="whole")

    @property
    def is_arbitrary(self) -> bool:
        """Whether there are no rules."""
        return self == ANY_SIGNAL

    def dwell_times(self) -> Iterator[tuple[tuple[str, ...], DwellTime]]:
        """Yield every time in a mode that is written, and where it is: field, and mode if any."""
        for field in ("dwell_time", "longest_dwell_time"):
            written = getattr(self, field)
            if isinstance(written, DwellTime):
                yield (field,), written
            elif written is not None:
                yield from (((field, name), dwell) for name, dwell in written.items())

    def stay(self, name: str) -> tuple[DwellTime | None, DwellTime | None]:
        """Return the shortest and the longest time in a mode."""
        return _of(self.dwell_time, name), _of(self.longest_dwell_time, name)

    @property
    def names_contacts(self) -> bool:
        """Tell whether rules name controllers with one contact each, such as ``tissue/soft``."""
        named = (name for at, _ in self.dwell_times() for name in at[1:])
        ends = (name for transition in self.transitions or () for name in transition)
        return any("/" in name for name in (*named, *ends))

    @property
    def of_a_run(self) -> SwitchingSpec:
        """The rules that a run can be held against.

        It says which controller is active, not what is touched.
        """
        return SwitchingSpec() if self.names_contacts else self

    def __str__(self) -> str:
        """Say the rules in a few words."""
        rules = [
            f"{at[0].replace('_', ' ')} {dwell.text}" + "".join(f" in {name}" for name in at[1:])
            for at, dwell in self.dwell_times()
        ]
        if self.transitions is not None:
            rules.append(counted(len(self.transitions), "allowed transition"))
        return ", ".join(rules) or ARBITRARY


# Without rules. Made without validation, for which a validator would be built.
ANY_SIGNAL = SwitchingSpec.model_construct()


def _of(written: DwellTimes | None, name: str) -> DwellTime | None:
    return written.get(name) if isinstance(written, dict) else written


def _read_switching(value: object) -> object:
    if isinstance(value, str):
        if value != ARBITRARY:
            raise fault(f"{quoted(value)} is not known", _FORM)
        return ANY_SIGNAL
    if isinstance(value, dict) and not value:
        raise fault("no rule is given", _FORM)
    return value


def _rule(*words: str) -> ExpandedBy:
    mapping = {
        "type": "object",
        "properties": fields_schema(SwitchingSpec),
        "minProperties": 1,
        "additionalProperties": False,
    }
    return ExpandedBy(_read_switching, {"anyOf": [{"enum": list(words)}, mapping]})


SwitchingRule = Annotated[SwitchingSpec, _rule(ARBITRARY)]
# Specs with a mode logic turn it into rules in their own validator first.
LogicalRule = Annotated[SwitchingSpec, _rule(ARBITRARY, MODE_LOGIC)]


def _uneven(
    rows: Collection[Collection[object]],
) -> Iterator[tuple[Location, tuple[int, int, int]]]:
    """Yield rows of another length than the first, with both lengths."""
    n = len(next(iter(rows)))
    for index, row in enumerate(rows):
        if len(row) != n:
            yield (index,), (index + 1, len(row), n)


def is_long(numbers: Iterable[Fraction]) -> bool:
    """Tell whether numbers that are to be written over one denominator have a long one.

    A hundred coprime denominators of a hundred digits make one of ten thousand, in every entry.
    """
    common = 1
    for number in numbers:
        common = lcm(common, number.denominator)
        if common.bit_length() > MAX_DENOMINATOR_BITS:
            return True
    return False


def short_denominator(at: str, numbers: Callable[[Any], Iterable[Fraction]]) -> Row[Any]:
    """Return the check that numbers have a common denominator of few digits."""
    return Row(
        at,
        lambda s: is_long(numbers(s)),
        f"the least common denominator has more than {MAX_DENOMINATOR_BITS} binary digits",
        "write the numbers as decimals, or with fewer different denominators",
    )


def matrix_checks(
    key: str,
    rows: Callable[[Any], Collection[Collection[object]]],
    numbers: Callable[[Any], Iterable[Fraction]],
) -> tuple[Row[Any], ...]:
    """Return the checks of a matrix: rows of one length, a common denominator of few digits."""
    return (
        refuse(
            lambda s: (((key, *at), found) for at, found in _uneven(rows(s))),
            "row {0} has {1} entries, the first has {2}",
            "give all rows the same length",
        ),
        short_denominator(key, numbers),
    )


class ResetSpec(SpecModel, stronger="neither"):
    """What a switch does to the state, ``x+ = map x`` (thesis 5.9)."""

    source: Label = Field(alias="from", description="name of the mode before the switch")
    target: Label = Field(alias="to", description="name of the mode after the switch")
    map: _Matrix = required(
        "matrix of x+ = map x as a list of rows, exact: states after by states before the switch"
    )

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.map), len(self.map[0])

    checks = matrix_checks("map", lambda s: s.map, lambda s: (e for row in s.map for e in row))


def _left(
    switching: SwitchingSpec, names: Collection[str]
) -> Iterator[tuple[Location, str, DwellTime | None, DwellTime]]:
    """Yield modes that must be left, with the shortest and the longest time in them."""
    for name in names if switching.longest_dwell_time is not None else ():
        shortest, longest = switching.stay(name)
        if longest is not None:
            yield ("switching", "longest_dwell_time", name), name, shortest, longest


def _too_early(
    switching: SwitchingSpec, names: Collection[str], noun: str
) -> Iterator[tuple[Location, tuple[str, ...]]]:
    for at, name, shortest, longest in _left(switching, names):
        if shortest is not None and longest.value < shortest.value:
            yield at, (noun, name, longest.text, shortest.text)


def _nowhere(
    switching: SwitchingSpec, names: Collection[str], noun: str
) -> Iterator[tuple[Location, tuple[str, str]]]:
    """Yield modes that must be left, and that nothing may follow."""
    allowed = switching.transitions
    left = names if allowed is None and len(names) > 1 else {a for a, _ in allowed or ()}
    return ((at, (noun, name)) for at, name, *_ in _left(switching, names) if name not in left)


def _named(
    switching: SwitchingSpec, names: Collection[str], noun: str
) -> Iterator[tuple[Location, Reference]]:
    for at, _ in switching.dwell_times():
        for name in at[1:]:
            yield ("switching", *at), Reference(noun, name, names)
    for index, transition in enumerate(switching.transitions or ()):
        for side, name in enumerate(transition):
            yield ("switching", "transitions", index, side), Reference(noun, name, names)


def switching_checks(
    rules: Callable[[Any], SwitchingSpec], names: Callable[[Any], Collection[str]], noun: str
) -> tuple[Row[Any], ...]:
    """Return the checks that rules name what exists, and can be kept.

    `noun` is mode or controller, for faults.
    """
    return (
        *each(lambda s: _named(rules(s), names(s), noun), NO_SUCH),
        refuse(
            lambda s: _too_early(rules(s), names(s), noun),
            "{0} {1!r} must be left after {2}, but not before {3}",
            "give a longest dwell time that is not below the dwell time",
        ),
        refuse(
            lambda s: _nowhere(rules(s), names(s), noun),
            "{0} {1!r} must be left, but nothing may follow it",
            "allow a switch from {1}, or give it no longest dwell time",
        ),
    )
