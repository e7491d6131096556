"""The spec of a raw switched system: its state matrices, read exactly."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from functools import partial
from typing import Annotated, Literal

from pydantic import Field, model_validator

from nrs_design.spec.certification import CertificationSpec
from nrs_design.spec.dwell import DwellObstacle, find_changing_parameter
from nrs_design.spec.faults import all_of, did_you_mean, fault
from nrs_design.spec.fields import Label, Name, Title
from nrs_design.spec.model import SpecModel
from nrs_design.spec.parameters import MAX_PARAMETERS, Entry, ParameterName, ParameterSpec
from nrs_design.spec.switching import (
    MAX_DIMENSION,
    MAX_TRANSITIONS,
    ResetSpec,
    SwitchingRule,
    Transition,
    check_denominators,
    check_names,
    check_rows,
)

MAX_MODES = 20_000
MAX_ENTRIES = 1_000_000

_Row = Annotated[tuple[Entry, ...], Field(min_length=1, max_length=MAX_DIMENSION)]
_Matrix = Annotated[tuple[_Row, ...], Field(min_length=1, max_length=MAX_DIMENSION)]


class ModeSpec(SpecModel):
    """One mode ``x' = A x`` (or ``x+ = A x``)."""

    name: Label = Field(description="name of the mode, unique in this file")
    A: _Matrix = Field(
        description="state matrix as a list of rows, n x n with n <= 64; integers, decimals, "
        '"p/q" or expressions that are affine in the parameters such as "3/4*k - m + 0.5", read '
        "exactly; unit 1/s in continuous time"
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
        """Return the matrix at the given parameter values.

        Raises
        ------
        KeyError
            If a parameter of the matrix has no value.
        """
        return [[entry.at(values) for entry in row] for row in self.A]

    @model_validator(mode="after")
    def _check_square(self) -> ModeSpec:
        check_rows(self.A, "A")
        check_denominators((number for row in self.A for e in row for number in e.numbers), "A")
        n = len(self.A[0])
        if len(self.A) != n:
            raise fault(
                f"the matrix is {len(self.A)} x {n}, not square",
                "write as many rows as columns",
                "A",
            )
        return self


class SwitchedSystemSpec(SpecModel):
    """A finite family of linear modes, or of boxes of modes."""

    kind: Literal["switched-system"] = Field(description="what this file describes")
    name: Name = Field(description="short name: lower-case letters, digits, '.', '_', '-'")
    title: Title = Field(default="", description="one line for people, at most 200 characters")
    time: Literal["continuous", "discrete"] = Field(
        description="continuous: x' = A x; discrete: x+ = A x"
    )
    parameters: Annotated[dict[ParameterName, ParameterSpec], Field(max_length=MAX_PARAMETERS)] = (
        Field(
            default_factory=dict,
            description="uncertain numbers that the matrices depend on: name -> nominal and range",
        )
    )
    modes: Annotated[tuple[ModeSpec, ...], Field(min_length=1, max_length=MAX_MODES)] = Field(
        description="the modes, at least one; of the same size, unless resets link them"
    )
    switching: SwitchingRule = Field(
        description="when modes change: arbitrary, or rules with dwell_time and transitions"
    )
    resets: Annotated[tuple[ResetSpec, ...], Field(max_length=MAX_TRANSITIONS)] = Field(
        default=(),
        description="what switches do to the state; the others leave it as it is. Several from one "
        "mode to another are as many switches: any one of them may happen",
    )
    # The default is made without validation, for which a validator of its own would be built.
    certification: CertificationSpec = Field(
        default_factory=CertificationSpec.model_construct,
        description="how far the search for a proof goes",
    )

    @property
    def dimension(self) -> int:
        """Number of states n of the largest mode."""
        return max(mode.dimension for mode in self.modes)

    @property
    def has_ranges(self) -> bool:
        """Whether a parameter has a range."""
        return any(not parameter.fixed for parameter in self.parameters.values())

    def find_dwell_obstacle(self) -> DwellObstacle | None:
        """Say why no dwell time can be claimed for this spec, or None."""
        return find_changing_parameter(self.parameters)

    def across(self) -> tuple[Callable[[], object], ...]:
        """Return the checks between parts: parameters, names of modes, dwell times."""
        return (
            lambda: _check_parameters(self),
            lambda: check_names(self.switching, _modes_by_name(self.modes), "mode"),
            lambda: _check_dwell_times(self),
        )

    @model_validator(mode="after")
    def _check(self) -> SwitchedSystemSpec:
        modes = _modes_by_name(self.modes)
        all_of(*self.across())
        _check_resets(self, modes)
        _check_sizes(self, modes)
        return self


def _modes_by_name(modes: tuple[ModeSpec, ...]) -> dict[str, ModeSpec]:
    found: dict[str, ModeSpec] = {}
    for index, mode in enumerate(modes):
        if mode.name in found:
            raise fault(f"another mode is named {mode.name!r}", "rename it", "modes", index, "name")
        found[mode.name] = mode
    return found


def _check_parameters(spec: SwitchedSystemSpec) -> None:
    all_of(*(partial(_check_known, spec, index) for index in range(len(spec.modes))))
    used = frozenset[str]().union(*(mode.parameters for mode in spec.modes))
    constant = [name for name, parameter in spec.parameters.items() if not parameter.varies]
    if len(constant) > 1:
        raise fault(
            f"{constant[0]!r} has varies: false already, and at most one parameter may",
            "leave it out here: what holds for a varying parameter holds for a constant one",
            "parameters",
            constant[1],
            "varies",
        )
    for name in spec.parameters:
        if name not in used:
            raise fault(
                "no matrix depends on this parameter", "remove it or use it", "parameters", name
            )
    values = (v for p in spec.parameters.values() for v in (p.nominal, *p.range))
    check_denominators(values, "parameters")
    corners = sum(2 ** len(mode.parameters) for mode in spec.modes)
    entries = sum(2 ** len(mode.parameters) * mode.dimension**2 for mode in spec.modes)
    if entries > MAX_ENTRIES:
        raise fault(
            f"the corners of the modes have {entries} entries in all, at most {MAX_ENTRIES} are "
            "read",
            "declare fewer parameters",
            "parameters",
        )
    if corners > MAX_MODES:
        raise fault(
            f"the modes have {corners} corners in all, at most {MAX_MODES} are read",
            "declare fewer parameters",
            "parameters",
        )


def _check_known(spec: SwitchedSystemSpec, index: int) -> None:
    if spec.modes[index].parameters <= spec.parameters.keys():
        return

    def check(name: str, *at: int) -> None:
        if name not in spec.parameters:
            known = did_you_mean(name, spec.parameters, "parameters here are")
            raise fault(
                f"{name!r} is not a number, and there is no parameter of that name",
                known if spec.parameters else "write a number, or declare parameters",
                "modes",
                index,
                "A",
                *at,
            )

    all_of(
        *(
            partial(check, name, i, j)
            for i, row in enumerate(spec.modes[index].A)
            for j, entry in enumerate(row)
            for name in sorted(entry.names)
        )
    )


def _check_dwell_times(spec: SwitchedSystemSpec) -> None:
    unit, example = ("s", "2.76 s") if spec.time == "continuous" else ("steps", "3 steps")
    obstacle = spec.find_dwell_obstacle()
    for at, dwell in spec.switching.dwell_times():
        if dwell.unit != unit:
            raise fault(
                f"{dwell.text!r} is not a dwell time in {spec.time} time, expected {unit}",
                f"such as {example!r}",
                *("switching", *at),
            )
        if obstacle is not None:
            raise fault(
                obstacle.message, f"leave {at[0]} out, or {obstacle.remedy}", *("switching", *at)
            )


def _check_resets(spec: SwitchedSystemSpec, modes: Mapping[str, ModeSpec]) -> None:
    allowed = None if spec.switching.transitions is None else set(spec.switching.transitions)
    found: set[ResetSpec] = set()
    for index, reset in enumerate(spec.resets):
        at = ("resets", index)
        for key, name in (("from", reset.source), ("to", reset.target)):
            if name not in modes:
                raise fault(f"there is no mode {name!r}", did_you_mean(name, modes), *at, key)
        transition = (reset.source, reset.target)
        if reset.source == reset.target:
            raise fault("a switch leads to another mode", "name two modes", *at, "to")
        if allowed is not None and transition not in allowed:
            raise fault(
                f"the switch from {reset.source} to {reset.target} is not allowed",
                "add it to switching.transitions, or remove this reset",
                *at,
            )
        if reset in found:
            raise fault("this reset is listed twice", "list each once", *at)
        _check_shape(reset, modes, *at)
        found.add(reset)


def _check_shape(reset: ResetSpec, modes: Mapping[str, ModeSpec], *at: int | str) -> None:
    rows, columns = modes[reset.target].dimension, modes[reset.source].dimension
    if reset.shape != (rows, columns):
        raise fault(
            f"the map is {reset.shape[0]} x {reset.shape[1]}, expected {rows} x {columns}: "
            f"{reset.target} has {rows} states, {reset.source} has {columns}",
            "write a row for each state after the switch, a column for each state before it",
            *(*at, "map"),
        )


def _check_sizes(spec: SwitchedSystemSpec, modes: Mapping[str, ModeSpec]) -> None:
    """Check that a switch between different states says what becomes of the state."""
    if len({mode.dimension for mode in spec.modes}) == 1:
        return
    resets = {(reset.source, reset.target) for reset in spec.resets}
    for (source, target), at in _transitions(spec):
        n, m = modes[source].dimension, modes[target].dimension
        if n != m and (source, target) not in resets:
            raise fault(
                f"{source} has {n} states and {target} has {m}, and the switch from {source} to "
                f"{target} has no reset",
                f"give all modes the same size, or add {{from: {source}, to: {target}, map: ...}} "
                f"with {m} x {n} entries to resets",
                *at,
            )


def _transitions(
    spec: SwitchedSystemSpec,
) -> Iterator[tuple[Transition, tuple[str | int, ...]]]:
    """Yield the allowed transitions, and where to report a fault of each."""
    if spec.switching.transitions is not None:
        for index, transition in enumerate(spec.switching.transitions):
            yield transition, ("switching", "transitions", index)
        return
    for source in spec.modes:
        for index, target in enumerate(spec.modes):
            if source is not target:
                yield (source.name, target.name), ("modes", index, "A")
