"""The spec of a raw switched system: its state matrices, read exactly."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Annotated, Literal

from pydantic import Field

from nrs_design.spec import switching as rules
from nrs_design.spec.certification import SearchExtent
from nrs_design.spec.check import NO_SUCH, Reference, Row, each, refuse
from nrs_design.spec.faults import Location, did_you_mean
from nrs_design.spec.fields import Label, Name, Title
from nrs_design.spec.misses import MissesSpec
from nrs_design.spec.model import SpecModel, optional, required
from nrs_design.spec.parameters import MAX_PARAMETERS, Entry, ParameterName, ParameterSpec

MAX_MODES = 20_000
MAX_ENTRIES = 1_000_000

_Row = Annotated[tuple[Entry, ...], Field(min_length=1, max_length=rules.MAX_DIMENSION)]
_Matrix = Annotated[tuple[_Row, ...], Field(min_length=1, max_length=rules.MAX_DIMENSION)]


class ModeSpec(SpecModel, stronger="neither"):
    """One mode ``x' = A x`` (or ``x+ = A x``)."""

    name: Label = required("name of the mode, unique in this file")
    A: _Matrix = required(
        "n x n state matrix as a list of rows, n <= 64, in 1/s in continuous time; integers, "
        'decimals, "p/q" or expressions such as "3/4*k - m + 0.5" that are affine in the '
        "parameters"
    )

    @property
    def dimension(self) -> int:
        """Number of states n."""
        return len(self.A)

    @property
    def parameters(self) -> frozenset[str]:
        """Names of the parameters that the matrix depends on."""
        return frozenset(name for row in self.A for entry in row for name in entry.names)

    def matrix(self, values: Mapping[str, Fraction]) -> list[list[Fraction]]:
        """Return the matrix at the given parameter values; a KeyError if one is missing."""
        return [[entry.at(values) for entry in row] for row in self.A]

    def _not_square(self) -> tuple[int, int] | None:
        rows, columns = len(self.A), len(self.A[0])
        even = all(len(row) == columns for row in self.A)
        return (rows, columns) if even and rows != columns else None

    checks = (
        *rules.matrix_checks(
            "A",
            lambda s: s.A,
            lambda s: (number for row in s.A for e in row for number in e.numbers),
        ),
        Row(
            "A", _not_square, "the matrix is {0} x {1}, not square", "write as many rows as columns"
        ),
    )


class SwitchedSystemSpec(SpecModel, stronger="unknown"):
    """A finite family of linear modes, or of boxes of modes."""

    kind: Literal["switched-system"] = required("what this file describes")
    name: Name = required("short name: lower-case letters, digits, '.', '_', '-'", "neither")
    title: Title = optional("one line for people, at most 200 characters", "", stronger="beside")
    time: Literal["continuous", "discrete"] = required("continuous: x' = A x; discrete: x+ = A x")
    parameters: Annotated[dict[ParameterName, ParameterSpec], Field(max_length=MAX_PARAMETERS)] = (
        optional(
            "uncertain numbers that the matrices depend on: name -> nominal and range",
            {},
            stronger="holding",
        )
    )
    modes: Annotated[tuple[ModeSpec, ...], Field(min_length=1, max_length=MAX_MODES)] = required(
        "the modes, at least one; of the same size, unless resets link them"
    )
    switching: rules.SwitchingRule = required("arbitrary, or rules with dwell_time and transitions")
    misses: MissesSpec | None = optional(
        "deadlines that may be missed, in discrete time, instead of rules of switching",
        unsaid="most",
    )
    resets: Annotated[tuple[rules.ResetSpec, ...], Field(max_length=rules.MAX_TRANSITIONS)] = (
        optional(
            "what switches do to the state; of several for one switch any may happen",
            (),
        )
    )
    certification: SearchExtent

    @property
    def dimension(self) -> int:
        """Number of states n of the largest mode."""
        return max(mode.dimension for mode in self.modes)

    @property
    def has_ranges(self) -> bool:
        """Whether a parameter has a range."""
        return any(not parameter.fixed for parameter in self.parameters.values())

    def find_dwell_obstacle(self) -> rules.DwellObstacle | None:
        """Say why no dwell time can be claimed for this spec, or None."""
        # A proof with a dwell time rests on one constant matrix from each switch to the next.
        for name, parameter in self.parameters.items():
            if not parameter.fixed:
                return rules.DwellObstacle(
                    f"a dwell time and the range of parameter {name!r} exclude each other: the "
                    "proof with a dwell time holds for constant matrices only",
                    "give the parameter its nominal value only",
                )
        return None


def _resets(spec: SwitchedSystemSpec) -> Iterator[tuple[Location, rules.ResetSpec, bool]]:
    """Yield resets, and whether their modes are there."""
    names = {mode.name for mode in spec.modes}
    for index, reset in enumerate(spec.resets):
        yield ("resets", index), reset, names >= {reset.source, reset.target}


def _not_allowed(spec: SwitchedSystemSpec) -> Iterator[tuple[Location, tuple[str, str]]]:
    """Yield resets of switches from one mode to another that no rule allows."""
    allowed = {*spec.switching.transitions} if spec.switching.transitions is not None else None
    for at, reset, known in _resets(spec):
        ends = reset.source, reset.target
        if allowed is not None and known and reset.source != reset.target and ends not in allowed:
            yield at, ends


def _misshapen(
    spec: SwitchedSystemSpec,
) -> Iterator[tuple[Location, tuple[int, int, int, int, str, str]]]:
    """Yield rows and columns of maps that have not those of their modes, theirs, and the modes."""
    sizes = {mode.name: mode.dimension for mode in spec.modes}
    for at, reset, known in _resets(spec):
        source, target = reset.source, reset.target
        if known and reset.shape != (sizes[target], sizes[source]):
            yield (*at, "map"), (*reset.shape, sizes[target], sizes[source], target, source)


def _named_modes(spec: SwitchedSystemSpec) -> Iterator[tuple[Location, Reference]]:
    names = dict.fromkeys(mode.name for mode in spec.modes)
    if spec.misses is not None:
        yield ("misses", "mode"), Reference("mode", spec.misses.mode, names)
    for at, reset, _ in _resets(spec):
        for key, name in (("from", reset.source), ("to", reset.target)):
            yield (*at, key), Reference("mode", name, names)


def _renamed(spec: SwitchedSystemSpec) -> Iterator[tuple[Location, str]]:
    """Yield names of modes that another one has before."""
    known: set[str] = set()
    for index, mode in enumerate(spec.modes):
        if mode.name in known:
            yield ("modes", index, "name"), mode.name
        known.add(mode.name)


def _undeclared(spec: SwitchedSystemSpec) -> Iterator[tuple[Location, tuple[str, str]]]:
    """Yield the undeclared parameters in the matrices, with the remedy."""
    known = spec.parameters.keys()
    for index, mode in enumerate(spec.modes):
        if mode.parameters <= known:
            continue
        for i, row in enumerate(mode.A):
            for j, entry in enumerate(row):
                for name in sorted({*entry.names} - known):
                    meant = did_you_mean(name, known, "parameters here are")
                    meant = meant if known else "write a number, or declare parameters"
                    yield ("modes", index, "A", i, j), (name, meant)


def _unused(spec: SwitchedSystemSpec) -> Iterator[str]:
    used = frozenset[str]().union(*(mode.parameters for mode in spec.modes))
    return (name for name in spec.parameters if name not in used)


def _corners(spec: SwitchedSystemSpec) -> int:
    return sum(2 ** len(mode.parameters) for mode in spec.modes)


def _entries(spec: SwitchedSystemSpec) -> int:
    return sum(2 ** len(mode.parameters) * mode.dimension**2 for mode in spec.modes)


# The unit of dwell times, and an example.
_UNITS = {"continuous": ("s", "2.76 s"), "discrete": ("steps", "3 steps")}


def _other_units(spec: SwitchedSystemSpec) -> Iterator[tuple[Location, tuple[str, ...]]]:
    unit, example = _UNITS[spec.time]
    for at, dwell in spec.switching.dwell_times():
        if dwell.unit != unit:
            yield ("switching", *at), (dwell.text, spec.time, unit, example)


def _obstacles(spec: SwitchedSystemSpec) -> Iterator[tuple[Location, tuple[str, ...]]]:
    if (found := spec.find_dwell_obstacle()) is not None:
        for at, _ in spec.switching.dwell_times():
            yield ("switching", *at), (found.message, at[0], found.remedy)


def _sizes(spec: SwitchedSystemSpec) -> Iterator[tuple[Location, tuple[str, int, str, int]]]:
    """Yield a switch between states of different sizes that has no reset."""
    sizes = {mode.name: mode.dimension for mode in spec.modes}
    if len(set(sizes.values())) == 1:
        return
    resets = {(reset.source, reset.target) for reset in spec.resets}
    for (source, target), at in _transitions(spec):
        known = sizes.keys() >= {source, target}
        if known and sizes[source] != sizes[target] and (source, target) not in resets:
            yield at, (source, sizes[source], target, sizes[target])
            return


def _transitions(spec: SwitchedSystemSpec) -> Iterator[tuple[rules.Transition, Location]]:
    """Yield the allowed transitions, and where to report a fault of each."""
    if spec.switching.transitions is not None:
        for index, transition in enumerate(spec.switching.transitions):
            yield transition, ("switching", "transitions", index)
        return
    for source in spec.modes:
        for index, target in enumerate(spec.modes):
            if source is not target:
                yield (source.name, target.name), ("modes", index, "A")


SYSTEM_CHECKS: tuple[Row[SwitchedSystemSpec], ...] = (
    refuse(_renamed, "another mode is named {0!r}", "rename it"),
    refuse(_undeclared, "{0!r} is not a number, and there is no parameter of that name", "{1}"),
    Row("parameters.{0}", _unused, "no matrix depends on this parameter", "remove it or use it"),
    rules.short_denominator(
        "parameters", lambda s: (v for p in s.parameters.values() for v in (p.nominal, *p.range))
    ),
    Row(
        "parameters",
        lambda s: _entries(s) > MAX_ENTRIES and _entries(s),
        f"the corners of the modes have {{0}} entries in all, at most {MAX_ENTRIES} are read",
        "declare fewer parameters",
    ),
    Row(
        "parameters",
        lambda s: _corners(s) > MAX_MODES and _corners(s),
        f"the modes have {{0}} corners in all, at most {MAX_MODES} are read",
        "declare fewer parameters",
    ),
    *rules.switching_checks(
        lambda s: s.switching, lambda s: dict.fromkeys(mode.name for mode in s.modes), "mode"
    ),
    refuse(_other_units, "{0!r} is not a dwell time in {1} time, expected {2}", "such as {3!r}"),
    refuse(_obstacles, "{0}", "leave {1} out, or {2}"),
    *each(_named_modes, NO_SUCH),
    Row(
        "misses",
        lambda s: s.misses is not None and s.time == "continuous",
        "deadlines are missed at steps, and time is continuous",
        "write `time: discrete` and the matrices of a step, or remove misses",
    ),
    Row(
        "misses",
        lambda s: s.misses is not None and not (s.switching.is_arbitrary and not s.resets),
        "a rule for misses says which modes may follow each other, and so do other rules",
        "write `switching: arbitrary` without resets, or remove misses",
    ),
    Row(
        "misses",
        lambda s: (
            s.misses is not None and any(not (p.varies or p.fixed) for p in s.parameters.values())
        ),
        "constant parameters are not modelled beside a rule for misses",
        "remove `varies: false`, or misses",
    ),
    Row(
        "misses.mode",
        lambda s: s.misses is not None and len(s.modes) == 1,
        "there is no mode of a step in time",
        "add the mode of a hit beside that of a miss",
    ),
    refuse(
        lambda s: (((*at, "to"), r.source == r.target) for at, r, _ in _resets(s)),
        "a switch leads to another mode",
        "name two modes",
    ),
    refuse(
        _not_allowed,
        "the switch from {0} to {1} is not allowed",
        "add it to switching.transitions, or remove this reset",
    ),
    refuse(
        _misshapen,
        "the map is {0} x {1}, expected {2} x {3}: {4} has {2} states, {5} has {3}",
        "write a row for each state after the switch, a column for each state before it",
    ),
    refuse(
        _sizes,
        "{0} has {1} states and {2} has {3}, and the switch from {0} to {2} has no reset",
        "give all modes the same size, or add {{from: {0}, to: {2}, map: ...}} with {3} x {1} "
        "entries to resets",
    ),
)
SwitchedSystemSpec.checks = SYSTEM_CHECKS
